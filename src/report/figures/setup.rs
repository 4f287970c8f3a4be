//! Figure 1: the phantom and the probe, to scale.

use core::f64::consts::PI;
use core::iter::once;

use plotters::style::text_anchor::HPos;

use super::chart::{Area, DrawingResult, draw};
use super::diagram::{
    INCLUSION, LINE, PROBE, Place, WAX, arrow, dashes, dimension, layer_tint, path, say_at, shape,
};
use super::names::spread;
use super::style::{GREY, INK, WIDTH, text_width};
use super::{Draft, setup_words};
use crate::phantom::{Inclusion, Phantom, Support};
use crate::report::text::{millimetres, shortened};
use crate::report::{Study, Topic};

/// Pixels left of the walls for the names of layers, at least.
const LEFT: f64 = 74.0;
/// Pixels right of the walls for the depths of the inclusions, at least.
const RIGHT: f64 = 84.0;
/// Pixels of walls and floor that are drawn. Their real thickness is not known and plays no part.
const WALL: f64 = 26.0;
/// Pixels above the probe, for its name.
const TOP: f64 = 34.0;
/// Pixels of a layer that gets a dimension, and of the two lines of its label, at least.
const THICK: f64 = 42.0;
/// Chords that an ellipse is drawn with: a multiple of 4, so that a disc is drawn as high and wide as it is.
const CHORDS: usize = 120;
/// Most inclusions of other phantoms that are drawn in one phantom.
const MOST: usize = 100;

/// One drawing.
struct Scene<'a> {
    phantom: &'a Phantom,
    /// Inclusions of phantoms that differ from this one in nothing else, by depth.
    others: Vec<&'a Inclusion>,
    /// Pixels a metre.
    scale: f64,
    /// x = 0, pixels from the left.
    middle: f64,
    /// The undeformed surface, pixels from the top.
    surface: f64,
}

/// Figure 1 for the phantom of Figure 6, and for each other that differs in more than its inclusions from those before it.
///
/// Implements: REP-035.
pub fn drafts(study: &Study) -> Vec<Draft> {
    let maps = once(&study.reference).chain(&study.maps);
    let all: Vec<&Phantom> = maps.filter_map(|map| map.phantom()).collect();
    let (full, plain): (Vec<_>, Vec<_>) = all.iter().partition(|p| !p.inclusions.is_empty());
    let mut scenes: Vec<Scene<'_>> = Vec::new();
    for phantom in once(&study.deformed.phantom).chain(full).chain(plain) {
        if !scenes.iter().any(|scene| alike(scene.phantom, phantom)) {
            scenes.push(Scene::new(phantom, &all));
        }
    }
    let drafts = scenes.iter().enumerate();
    drafts.map(|(k, scene)| scene.draft(k > 0)).collect()
}

/// Whether two phantoms differ in names and inclusions alone.
fn alike(a: &Phantom, b: &Phantom) -> bool {
    let layers = |p: &Phantom| -> Vec<_> {
        let each = p.layers.iter();
        each.map(|layer| (layer.thickness, layer.material))
            .collect()
    };
    (a.well, a.probe, layers(a)) == (b.well, b.probe, layers(b))
}

/// Name and thickness of each layer.
fn layer_labels(phantom: &Phantom) -> Vec<[String; 2]> {
    let label = |layer: &crate::phantom::Layer| {
        let thickness = format!("{} mm", millimetres(layer.thickness));
        [shortened(&layer.name, 12), thickness]
    };
    phantom.layers.iter().map(label).collect()
}

fn depth_label(inclusion: &Inclusion) -> String {
    format!("{} mm", millimetres(inclusion.depth))
}

/// The corner of an outline that is furthest along `direction`.
fn furthest(corners: &[[f64; 2]], direction: [f64; 2]) -> [f64; 2] {
    let along = |p: &[f64; 2]| direction[0] * p[0] + direction[1] * p[1];
    let corner = corners.iter().max_by(|a, b| along(a).total_cmp(&along(b)));
    corner.copied().unwrap_or_default()
}

impl<'a> Scene<'a> {
    fn new(phantom: &'a Phantom, all: &[&'a Phantom]) -> Scene<'a> {
        let mut others: Vec<&Inclusion> = Vec::new();
        let like = all.iter().filter(|other| alike(other, phantom));
        for inclusion in like.flat_map(|other| &other.inclusions) {
            if !phantom.inclusions.contains(inclusion) && !others.contains(&inclusion) {
                others.push(inclusion);
            }
        }
        others.truncate(MOST);
        others.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        let widest = |labels: &[String]| {
            let widths = labels.iter().map(|label| text_width(label));
            f64::from(widths.max().unwrap_or(0))
        };
        let inclusions = phantom.inclusions.iter().chain(others.iter().copied());
        let depths: Vec<String> = inclusions.map(depth_label).collect();
        let left = LEFT.max(widest(&layer_labels(phantom).concat()) + 30.0);
        let right = RIGHT.max(widest(&depths) + 28.0);
        let wide = f64::from(WIDTH) - left - right - 2.0 * WALL;
        // The second bound keeps a tall phantom on the page.
        let high = phantom.height() + phantom.probe.radius;
        let scale = (wide / phantom.well.width).min(420.0 / high);
        Scene {
            phantom,
            others,
            scale,
            middle: left + WALL + 0.5 * wide,
            surface: TOP + scale * phantom.probe.radius,
        }
    }

    /// The place of the point (x, y), m, y upwards from the surface.
    fn at(&self, [x, y]: [f64; 2]) -> Place {
        [self.middle + self.scale * x, self.surface - self.scale * y]
    }

    /// Left and right wall, surface and floor, pixels.
    fn sides(&self) -> [f64; 4] {
        let half = 0.5 * self.phantom.well.width;
        let [left, floor] = self.at([-half, -self.phantom.height()]);
        [left, self.at([half, 0.0])[0], self.surface, floor]
    }

    /// Left, right, top and bottom of an inclusion, pixels.
    fn extent(&self, inclusion: &Inclusion) -> [f64; 4] {
        let [left, right, bottom, top] = inclusion.extent();
        let ([left, top], [right, bottom]) = (self.at([left, top]), self.at([right, bottom]));
        [left, right, top, bottom]
    }

    fn outline(&self, inclusion: &Inclusion) -> Vec<Place> {
        let corners = inclusion.outline().chords(CHORDS);
        corners.into_iter().map(|corner| self.at(corner)).collect()
    }

    fn draft(&self, is_named: bool) -> Draft {
        let listed = setup_words::materials(self.phantom, self.label().is_some());
        let [.., floor] = self.sides();
        let last = floor + WALL + 60.0;
        let height = (last + 24.0 + LINE * (listed.len() as f64 - 1.0)).ceil() as i32;
        let svg = draw(height, |area| {
            self.draw_well(area)?;
            self.draw_inclusions(area)?;
            self.draw_probe(area)?;
            self.draw_layers(area)?;
            self.draw_width(area)?;
            for (k, line) in listed.iter().enumerate() {
                let at = [0.5 * f64::from(WIDTH), last + LINE * k as f64];
                say_at(area, line, at, HPos::Center)?;
            }
            Ok(())
        });
        let name = if is_named { &*self.phantom.name } else { "" };
        Draft {
            prefix: "figure-1",
            name: name.into(),
            topic: Topic::Setup,
            words: setup_words::words(self.phantom, &self.others, is_named),
            drawn: svg.map(|svg| (svg, [WIDTH, height])),
        }
    }

    /// What is fixed is held by a block, what slides stands on rollers, and what is free has nothing at it.
    fn draw_well(&self, area: &Area<'_>) -> DrawingResult<()> {
        let well = &self.phantom.well;
        let [left, right, top, floor] = self.sides();
        let block = |[left, right, top, floor]: [f64; 4]| {
            [[left, top], [right, top], [right, floor], [left, floor]]
        };
        let margin = |support| if support == Support::Free { 0.0 } else { WALL };
        let (side, below) = (margin(well.walls), margin(well.floor));
        if side + below > 0.0 {
            let outside = [left - side, right + side, top, floor + below];
            shape(area, &block(outside), WAX)?;
        }
        let roller = |x: f64, y: f64| {
            let corners = (0..16).map(|k| libm::sincos(f64::from(k) * PI / 8.0));
            let corners: Vec<_> = corners.map(|(s, c)| [x + 4.0 * c, y + 4.0 * s]).collect();
            shape(area, &corners, plotters::style::WHITE)
        };
        let places = |from: f64, to: f64| {
            let count = ((to - from) / 12.0).floor().max(1.0);
            (0..count as u32).map(move |k| from + (to - from) * (f64::from(k) + 0.5) / count)
        };
        if well.walls == Support::Sliding {
            for y in places(top, floor) {
                roller(left - 4.0, y)?;
                roller(right + 4.0, y)?;
            }
        }
        if well.floor == Support::Sliding {
            for x in places(left, right) {
                roller(x, floor + 4.0)?;
            }
        }
        let levels = self.phantom.levels();
        for (k, pair) in levels.windows(2).enumerate().rev() {
            let [top, bottom] = [pair[0], pair[1]].map(|y| self.at([0.0, y])[1]);
            let tint = layer_tint(k, levels.len() - 1);
            shape(area, &block([left, right, top, bottom]), tint)?;
        }
        let words = setup_words::supports(self.phantom);
        let under = if well.floor == Support::Sliding {
            19.0
        } else {
            13.0
        };
        say_at(area, &words, [self.middle, floor + under], HPos::Center)
    }

    fn draw_inclusions(&self, area: &Area<'_>) -> DrawingResult<()> {
        for other in &self.others {
            let mut corners = self.outline(other);
            corners.extend(corners.first().copied());
            dashes(area, &corners, INK)?;
        }
        self.draw_depths(area)?;
        for own in &self.phantom.inclusions {
            shape(area, &self.outline(own), INCLUSION)?;
        }
        self.draw_numbers(area)?;
        let Some((words, line)) = self.label() else {
            return Ok(());
        };
        let count = words.len() as f64;
        for (k, words) in words.iter().enumerate() {
            let below = LINE * (k as f64 - 0.5 * (count - 1.0));
            let at = [line[0][0] - 4.0, line[0][1] + below];
            say_at(area, words, at, HPos::Right)?;
        }
        arrow(area, &line)
    }

    /// The depth of each top, right of the well; each depth once, and only as many as there is room for.
    fn draw_depths(&self, area: &Area<'_>) -> DrawingResult<()> {
        let [_, right, _, floor] = self.sides();
        let own = self.phantom.inclusions.iter();
        let mut all: Vec<_> = own.chain(self.others.iter().copied()).collect();
        all.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        all.dedup_by(|a, b| depth_label(a) == depth_label(b));
        let (edge, mut next) = (right + WALL + 6.0, f64::NEG_INFINITY);
        for inclusion in all {
            let top = self.at(furthest(&inclusion.outline().chords(CHORDS), [0.0, 1.0]));
            let height = top[1].max(next);
            if height > floor + WALL {
                break;
            }
            next = height + LINE - 2.0;
            dashes(area, &[top, [edge, top[1]]], GREY)?;
            path(area, &[[edge, top[1]], [edge + 10.0, height]], GREY, 1.2)?;
            say_at(
                area,
                &depth_label(inclusion),
                [edge + 14.0, height],
                HPos::Left,
            )?;
        }
        Ok(())
    }

    /// Whether words in the box between left, right, top and bottom, pixels, lie in the well and off all other inclusions.
    fn is_clear(&self, [left, right, top, bottom]: [f64; 4], own: &Inclusion) -> bool {
        let [wall, _, surface, floor] = self.sides();
        let all = self.phantom.inclusions.iter();
        let mut others = all.chain(self.others.iter().copied()).filter(|i| *i != own);
        let is_in_well = left > wall && top >= surface && bottom <= floor;
        is_in_well
            && others.all(|other| {
                let [l, r, t, b] = self.extent(other);
                right < l || r < left || bottom < t || b < top
            })
    }

    /// The words at the left of the only inclusion, and where the line from them to it begins and ends; `None` if there is no
    /// room for them.
    fn label(&self) -> Option<(Vec<String>, [Place; 2])> {
        let [inclusion] = &self.phantom.inclusions[..] else {
            return None;
        };
        let words = setup_words::beside(inclusion);
        let wide = words.iter().map(|line| text_width(line)).max()?;
        let corners = inclusion.outline().chords(CHORDS);
        let end = self.at(furthest(&corners, [-1.0, 0.0]));
        let start = [end[0] - 34.0, end[1]];
        let half = 0.5 * LINE * words.len() as f64;
        let left = start[0] - 4.0 - f64::from(wide);
        let is_clear = self.is_clear([left, start[0], end[1] - half, end[1] + half], inclusion);
        is_clear.then_some((words, [start, end]))
    }

    /// A number in each of several inclusions, or at its left if it is too small and there is room.
    fn draw_numbers(&self, area: &Area<'_>) -> DrawingResult<()> {
        let all = &self.phantom.inclusions;
        for (k, inclusion) in all.iter().enumerate().filter(|_| all.len() > 1) {
            let [left, right, top, bottom] = self.extent(inclusion);
            let number = (k + 1).to_string();
            let (wide, middle) = (f64::from(text_width(&number)), 0.5 * (top + bottom));
            let beside = [left - 4.0 - wide, left - 4.0, middle - 8.0, middle + 8.0];
            if right - left > wide + 2.0 && bottom - top > 16.0 {
                say_at(area, &number, [0.5 * (left + right), middle], HPos::Center)?;
            } else if self.is_clear(beside, inclusion) {
                say_at(area, &number, [left - 4.0, middle], HPos::Right)?;
            }
        }
        Ok(())
    }

    fn draw_probe(&self, area: &Area<'_>) -> DrawingResult<()> {
        let radius = self.phantom.probe.radius;
        let arc = (60..=120).map(|k| libm::sincos(f64::from(k) * PI / 60.0));
        let arc = arc.map(|(sine, cosine)| self.at([radius * cosine, radius + radius * sine]));
        shape(area, &arc.collect::<Vec<_>>(), PROBE)?;
        let [middle, top] = self.at([0.0, radius]);
        let name = format!(
            "probe: ø {} mm, {} mm long, rigid",
            millimetres(2.0 * radius),
            millimetres(self.phantom.probe.length)
        );
        say_at(area, &name, [middle, top - 14.0], HPos::Center)?;
        // Where the probe goes: x to the side, d into the gel.
        let [x, d] = [0.57, 0.5].map(|part| part * (self.surface - top));
        if d < 15.0 {
            return Ok(());
        }
        let centre = [middle, top + 0.72 * d];
        arrow(area, &[centre, [centre[0] + x, centre[1]]])?;
        say_at(area, "x", [centre[0] + x + 6.0, centre[1]], HPos::Left)?;
        arrow(area, &[centre, [centre[0], centre[1] + d]])?;
        say_at(
            area,
            "d",
            [centre[0] - 8.0, centre[1] + 0.6 * d],
            HPos::Right,
        )
    }

    /// Name and thickness of each layer at the left: of a thin one on top above the wall, of others beside it, and
    /// only of as many of the thickest as there is room for.
    fn draw_layers(&self, area: &Area<'_>) -> DrawingResult<()> {
        let [left, _, surface, floor] = self.sides();
        let labels = layer_labels(self.phantom);
        let levels = self.phantom.levels();
        let mut layers: Vec<_> = labels.iter().zip(levels.windows(2)).collect();
        let ends = |pair: &[f64]| [pair[0], pair[1]].map(|y| self.at([0.0, y])[1]);
        let line = left - WALL - 14.0;
        let first = layers
            .first()
            .map(|(words, pair)| (words.join(" "), ends(pair)));
        let radius = self.scale * self.phantom.probe.radius;
        let wide = |words: &str| f64::from(text_width(words));
        if let Some((words, [top, bottom])) = first
            && bottom - top < THICK
            // Left of the probe, below its name.
            && left.max(wide(&words) + 8.0) < self.middle - radius
            && radius > 34.0
        {
            layers.remove(0);
            let above = [left - WALL - 4.0, surface - 20.0];
            let start = (left - WALL + 21.0 - wide(&words)).max(8.0);
            say_at(area, &words, [start, surface - 30.0], HPos::Left)?;
            arrow(area, &[above, [left + 12.0, 0.5 * (top + bottom)]])?;
        }
        let range = [surface + 10.0, floor - 10.0];
        let room = 1.0 + ((range[1] - range[0]) / THICK).max(0.0).floor();
        layers.sort_by(|(_, a), (_, b)| (b[0] - b[1]).total_cmp(&(a[0] - a[1])));
        layers.truncate(room as usize);
        let middle = |pair: &[f64]| 0.5 * ends(pair).iter().sum::<f64>();
        let middles: Vec<_> = layers.iter().map(|(_, pair)| middle(pair) as i32).collect();
        let places = spread(&middles, THICK as i32, range.map(|end| end as i32));
        for ((words, pair), place) in layers.into_iter().zip(places) {
            let ([top, bottom], place) = (ends(pair), f64::from(place));
            if bottom - top < THICK {
                let inside = [left + 12.0, middle(pair)];
                arrow(area, &[[line - 5.0, place], [line, place], inside])?;
            } else {
                // Between thin lines from its edges.
                for height in [top, bottom] {
                    path(area, &[[line - 5.0, height], [left, height]], GREY, 1.0)?;
                }
                dimension(area, [[line, top], [line, bottom]])?;
            }
            for (words, shift) in words.iter().zip([-0.5, 0.5]) {
                let at = [line - 8.0, place + shift * LINE];
                say_at(area, words, at, HPos::Right)?;
            }
        }
        Ok(())
    }

    fn draw_width(&self, area: &Area<'_>) -> DrawingResult<()> {
        let [left, right, _, floor] = self.sides();
        let below = floor + WALL + 18.0;
        for x in [left, right] {
            path(area, &[[x, floor], [x, below + 5.0]], GREY, 1.0)?;
        }
        dimension(area, [[left, below], [right, below]])?;
        let width = format!("{} mm", millimetres(self.phantom.well.width));
        say_at(area, &width, [self.middle, below + 16.0], HPos::Center)
    }
}
