//! A CalculiX input deck of the gel in three dimensions: our mesh of the section, drawn out along z into wedges with 15 nodes.
//!
//! The plane z = 0 is one of symmetry, and where the probe stands at x = 0, so is the plane x = 0; a deck holds the part where z, and
//! then x, is positive. CalculiX's `*GREEN` gives the displacements under a unit force at each place that the probe may touch, from one
//! factorisation.

use std::collections::BTreeSet;
use std::fmt::Write;

use palpate::fem::Mesh;
use palpate::fem::mesh::Region;
use palpate::phantom::Phantom;

use super::deck::law;
use super::material;

/// What bounds the gel along z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ends {
    /// A wall that holds it; probe and inclusion end before, half the probe's length from the middle.
    Fixed,
    /// Nothing moves along z anywhere, and probe and inclusion have no ends: plane strain.
    Plane,
}

/// A half of a gel, or a quarter where the probe stands at x = 0.
pub struct Part<'a> {
    /// What is symmetric about x = 0.
    pub phantom: &'a Phantom,
    /// Where the probe stands, m.
    pub lateral: f64,
    /// The section.
    pub mesh: &'a Mesh,
    /// Where along z, m, it is cut into wedges, from its middle to its end.
    pub cuts: &'a [f64],
    pub ends: Ends,
}

/// A node at the surface.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Its number in the deck.
    pub number: usize,
    /// Its lateral position, m.
    pub x: f64,
}

impl Part<'_> {
    /// The deck, which prints the displacements of the `places` under each of the `loads`, 1 N at a place along x (0) or y (1).
    pub fn deck(&self, places: &[Place], loads: &[(usize, usize)]) -> String {
        let mut deck = String::from("*NODE, NSET=ALL\n");
        for (node, level) in self.nodes() {
            let ([x, y], z) = (self.mesh.nodes[node as usize], self.z(level));
            let number = self.node(node, level);
            writeln!(deck, "{number}, {x:.12e}, {y:.12e}, {z:.12e}").unwrap();
        }
        self.elements(&mut deck);
        deck += "*NSET, NSET=PLACES\n";
        for place in places {
            writeln!(deck, "{},", place.number).unwrap();
        }
        self.supports(&mut deck);
        deck += "*STEP\n*GREEN\n*CLOAD\n";
        for (place, direction) in loads {
            writeln!(deck, "{}, {}, 1.", places[*place].number, direction + 1).unwrap();
        }
        deck += "*NODE PRINT, NSET=PLACES\nU\n*END STEP\n";
        deck
    }

    /// How many such parts make up the gel.
    pub fn of_the_gel(&self) -> f64 {
        if self.lateral == 0.0 { 4.0 } else { 2.0 }
    }

    /// Where the probe may touch: the nodes at the surface up to `reach`, m, from its axis and below its length.
    pub fn places(&self, reach: f64) -> Vec<Place> {
        let place = |(node, level): (u32, usize)| {
            let ([x, y], z) = (self.mesh.nodes[node as usize], self.z(level));
            let number = self.node(node, level);
            let below = self.ends == Ends::Plane || z <= self.end() + 1e-9;
            (y == 0.0 && (x - self.lateral).abs() <= reach && below).then_some(Place { number, x })
        };
        self.nodes().into_iter().filter_map(place).collect()
    }

    /// Where probe and inclusion end, m.
    fn end(&self) -> f64 {
        0.5 * self.phantom.probe().length
    }

    fn z(&self, level: usize) -> f64 {
        (self.cuts[level / 2] + self.cuts[level.div_ceil(2)]) / 2.0
    }

    /// Each element of the section's part, in each slice: its number, its region, its nodes in the section, the slice.
    fn wedges(&self) -> impl Iterator<Item = (usize, Region, &[u32], usize)> {
        let least = if self.lateral == 0.0 {
            0.0
        } else {
            f64::NEG_INFINITY
        };
        let inside = move |nodes: &[u32]| {
            nodes
                .iter()
                .all(|&n| self.mesh.nodes[n as usize][0] >= least)
        };
        let section = self.mesh.elements().enumerate();
        let section = section.filter(move |(_, nodes)| inside(nodes));
        section.flat_map(move |(element, nodes)| {
            (0..self.cuts.len() - 1).map(move |slice| {
                let number = 1 + element + self.mesh.regions.len() * slice;
                (number, self.region(element, slice), nodes, slice)
            })
        })
    }

    /// What a slice of an element is made of: beyond the end of an inclusion it is gel.
    fn region(&self, element: usize, slice: usize) -> Region {
        let beyond = self.ends == Ends::Fixed && self.cuts[slice] >= self.end() - 1e-9;
        match self.mesh.regions[element] {
            Region::Inclusion(_) if beyond => Region::Layer(1),
            region => region,
        }
    }

    /// The number of a section's node at a level: even ones are the cuts, odd ones lie between them and hold corners alone.
    fn node(&self, node: u32, level: usize) -> usize {
        1 + node as usize + self.mesh.nodes.len() * level
    }

    /// Every node of the section at every level that has one.
    fn nodes(&self) -> BTreeSet<(u32, usize)> {
        let of_wedge = |(_, _, nodes, slice): (usize, Region, &[u32], usize)| {
            let levels = [(2 * slice, 6), (2 * slice + 1, 3), (2 * slice + 2, 6)];
            let at = |(level, many)| nodes[..many].iter().map(move |&node| (node, level));
            levels.into_iter().flat_map(at).collect::<Vec<_>>()
        };
        self.wedges().flat_map(of_wedge).collect()
    }

    fn elements(&self, deck: &mut String) {
        let layers = (0..self.phantom.layers().len()).map(Region::Layer);
        let inclusions = (0..self.phantom.inclusions().len()).map(Region::Inclusion);
        for (set, region) in layers.chain(inclusions).enumerate() {
            writeln!(deck, "*ELEMENT, TYPE=C3D15, ELSET=REGION{set}").unwrap();
            for (number, _, nodes, slice) in self.wedges().filter(|wedge| wedge.1 == region) {
                let (corners, middles) = nodes.split_at(3);
                let (low, high) = (2 * slice, 2 * slice + 2);
                let parts = [
                    (corners, low),
                    (corners, high),
                    (middles, low),
                    (middles, high),
                    (corners, low + 1),
                ];
                write!(deck, "{number}").unwrap();
                for (part, level) in parts {
                    for &node in part {
                        write!(deck, ", {}", self.node(node, level)).unwrap();
                    }
                }
                *deck += "\n";
            }
            let law = law(self.phantom.strain(), &material(self.phantom, region));
            write!(
                deck,
                "*MATERIAL, NAME=REGION{set}\n{law}*SOLID SECTION, ELSET=REGION{set}, MATERIAL=REGION{set}\n"
            )
            .unwrap();
        }
    }

    /// Walls, floor and planes of symmetry.
    fn supports(&self, deck: &mut String) {
        let last = 2 * self.cuts.len() - 2;
        *deck += "*BOUNDARY\n";
        for (node, level) in self.nodes() {
            let number = self.node(node, level);
            let at_end = self.ends == Ends::Fixed && level == last;
            if self.mesh.held[node as usize] == [true; 2] || at_end {
                writeln!(deck, "{number}, 1, 3").unwrap();
                continue;
            }
            if self.lateral == 0.0 && self.mesh.nodes[node as usize][0] == 0.0 {
                writeln!(deck, "{number}, 1, 1").unwrap();
            }
            if level == 0 || self.ends == Ends::Plane {
                writeln!(deck, "{number}, 3, 3").unwrap();
            }
        }
    }
}
