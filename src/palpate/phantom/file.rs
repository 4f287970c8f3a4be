//! Phantom files: TOML, in mm and kPa (`spec/phantom.md`).

use std::fmt::Display;
use std::path::Path;

use serde::Deserialize;

use super::{
    Geometry, Inclusion, Layer, Material, Phantom, PhantomParts, Probe, Shape, Strain, Support,
    Well,
};
use crate::decimal::{Kpa, Mm, Plain, Scaled, kpa, mm, plain};
use crate::file::Tree;
use crate::refusal::Refusal;

/// A phantom in the keys and units of its file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct PhantomFile {
    name: String,
    #[serde(default)]
    strain: Strain,
    #[serde(default)]
    geometry: Geometry,
    well: WellTable,
    layer: Vec<LayerTable>,
    #[serde(default)]
    inclusion: Vec<InclusionTable>,
    probe: ProbeTable,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct WellTable {
    width_mm: Mm,
    #[serde(default)]
    walls: Support,
    #[serde(default)]
    floor: Support,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct LayerTable {
    name: Option<String>,
    thickness_mm: Mm,
    youngs_modulus_kpa: Kpa,
    poisson_ratio: Plain,
    yeoh_c20_kpa: Option<Kpa>,
    fibre_modulus_kpa: Option<Kpa>,
    fibre_angle_deg: Option<Plain>,
}

/// An inclusion, with the keys of any shape.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct InclusionKeys {
    centre_x_mm: Option<Mm>,
    depth_mm: Mm,
    diameter_mm: Option<Mm>,
    width_mm: Option<Mm>,
    height_mm: Option<Mm>,
    angle_deg: Option<Plain>,
    points_mm: Option<Vec<[Mm; 2]>>,
    youngs_modulus_kpa: Kpa,
    poisson_ratio: Plain,
    yeoh_c20_kpa: Option<Kpa>,
    fibre_modulus_kpa: Option<Kpa>,
    fibre_angle_deg: Option<Plain>,
}

/// An inclusion, with the keys of one shape.
#[derive(Deserialize)]
#[serde(try_from = "InclusionKeys")]
struct InclusionTable(Inclusion);

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct ProbeTable {
    radius_mm: Mm,
    length_mm: Mm,
    friction: Option<Plain>,
}

impl From<PhantomFile> for PhantomParts {
    fn from(file: PhantomFile) -> PhantomParts {
        let layer = |(at, layer): (usize, LayerTable)| Layer {
            name: layer.name.unwrap_or_else(|| format!("layer[{at}]")),
            thickness: layer.thickness_mm.0,
            material: Material {
                yeoh_c20: number(layer.yeoh_c20_kpa),
                fibre_modulus: number(layer.fibre_modulus_kpa),
                fibre_angle_deg: number(layer.fibre_angle_deg),
                ..Material::isotropic(layer.youngs_modulus_kpa.0, layer.poisson_ratio.0)
            },
        };
        PhantomParts {
            name: file.name,
            strain: file.strain,
            geometry: file.geometry,
            well: Well {
                width: file.well.width_mm.0,
                walls: file.well.walls,
                floor: file.well.floor,
            },
            layers: file.layer.into_iter().enumerate().map(layer).collect(),
            inclusions: file.inclusion.into_iter().map(|table| table.0).collect(),
            probe: Probe {
                radius: file.probe.radius_mm.0,
                length: file.probe.length_mm.0,
                friction: number(file.probe.friction),
            },
        }
    }
}

impl TryFrom<InclusionKeys> for InclusionTable {
    type Error = String;

    fn try_from(keys: InclusionKeys) -> Result<InclusionTable, String> {
        Ok(InclusionTable(Inclusion {
            centre_x: number(keys.centre_x_mm),
            depth: keys.depth_mm.0,
            shape: keys.shape()?,
            material: Material {
                yeoh_c20: number(keys.yeoh_c20_kpa),
                fibre_modulus: number(keys.fibre_modulus_kpa),
                fibre_angle_deg: number(keys.fibre_angle_deg),
                ..Material::isotropic(keys.youngs_modulus_kpa.0, keys.poisson_ratio.0)
            },
        }))
    }
}

impl InclusionKeys {
    /// The shape whose keys are there, without any of another.
    fn shape(&self) -> Result<Shape, String> {
        let (sizes, points) = ([self.width_mm, self.height_mm], &self.points_mm);
        match (self.diameter_mm, sizes, self.angle_deg, points) {
            (Some(Scaled(diameter)), [None, None], None, None) => Ok(Shape::Disc { diameter }),
            (None, [Some(Scaled(width)), Some(Scaled(height))], angle, None) => {
                let angle_deg = number(angle);
                Ok(Shape::Ellipse {
                    width,
                    height,
                    angle_deg,
                })
            }
            (None, [None, None], None, Some(points)) => {
                let points = points.iter().map(|point| point.map(|length| length.0));
                let points = points.collect();
                Ok(Shape::Polygon { points })
            }
            _ => {
                let keys = [
                    ("diameter_mm", self.diameter_mm.is_some()),
                    ("width_mm", self.width_mm.is_some()),
                    ("height_mm", self.height_mm.is_some()),
                    ("angle_deg", self.angle_deg.is_some()),
                    ("points_mm", self.points_mm.is_some()),
                ];
                let there: Vec<_> = keys.iter().filter(|key| key.1).map(|key| key.0).collect();
                let found = match &there[..] {
                    [] => "no shape".into(),
                    keys => keys.join(" and "),
                };
                let shapes = "diameter_mm, or width_mm and height_mm, or points_mm";
                Err(format!("has {found}: give {shapes}"))
            }
        }
    }
}

/// The number under a key that may be missing, else 0.
fn number<const POWER: i32>(written: Option<Scaled<POWER>>) -> f64 {
    written.map_or(0.0, |number| number.0)
}

impl Phantom {
    /// Reads the phantom file at `path`.
    ///
    /// # Errors
    /// As [`Phantom::from_toml`]; also if the file cannot be read as UTF-8.
    pub fn read(path: &Path) -> Result<Phantom, Refusal> {
        crate::file::read(path, Phantom::from_toml)
    }

    /// The phantom in `text`, the content of `file`, which is named in errors alone.
    ///
    /// ```
    /// use palpate::phantom::Phantom;
    ///
    /// let text = r#"
    /// name = "soft, without inclusion"
    /// well = { width_mm = 34, walls = "sliding" }
    /// layer = [{ thickness_mm = 15, youngs_modulus_kpa = 2.5, poisson_ratio = 0.49 }]
    /// probe = { radius_mm = 6.5, length_mm = 30 }
    /// "#;
    /// let phantom = Phantom::from_toml(text, "soft.toml")?;
    /// assert_eq!((phantom.well().width, phantom.layers()[0].material.youngs_modulus), (0.034, 2500.0));
    /// let error = Phantom::from_toml(&text.replace("6.5", "17.0"), "wide.toml").unwrap_err();
    /// assert!(error.to_string().starts_with("wide.toml:5: probe.radius_mm = 17.0, but must be "));
    /// # Ok::<(), palpate::refusal::Refusal>(())
    /// ```
    ///
    /// # Errors
    /// The text is not TOML, has an unknown key, lacks one, has a value of another type, or makes a phantom that
    /// [`Phantom::new`] refuses; with the file, and the line where there is one.
    ///
    /// Implements: PHA-020, PHA-021, PHA-026.
    pub fn from_toml(text: &str, file: &str) -> Result<Phantom, Refusal> {
        let phantom = Tree::parse(text).and_then(from_tree);
        phantom.map_err(|refusal| refusal.in_file(file))
    }

    /// This phantom as the text of a phantom file.
    ///
    /// Implements: PHA-021, PHA-027.
    pub fn to_toml(&self) -> String {
        let quoted = |name: &str| toml::Value::from(name).to_string();
        let Well {
            width,
            walls,
            floor,
        } = self.0.well;
        let (name, width) = (quoted(&self.0.name), mm(width));
        let mut kind = String::new();
        if self.0.strain != Strain::default() {
            kind += &format!("strain = \"{}\"\n", self.0.strain);
        }
        if self.0.geometry != Geometry::default() {
            kind += &format!("geometry = \"{}\"\n", self.0.geometry);
        }
        let mut text = format!(
            "name = {name}\n{kind}\n[well]\nwidth_mm = {width}\nwalls = \"{walls}\"\nfloor = \"{floor}\"\n"
        );
        for layer in &self.0.layers {
            let (name, thickness) = (quoted(&layer.name), mm(layer.thickness));
            let material = material_lines(&layer.material);
            text += &format!("\n[[layer]]\nname = {name}\nthickness_mm = {thickness}\n{material}");
        }
        for inclusion in &self.0.inclusions {
            let (x, depth) = (mm(inclusion.centre_x), mm(inclusion.depth));
            let shape = shape_lines(&inclusion.shape);
            let material = material_lines(&inclusion.material);
            text += &format!(
                "\n[[inclusion]]\ncentre_x_mm = {x}\ndepth_mm = {depth}\n{shape}{material}"
            );
        }
        let (radius, length) = (mm(self.0.probe.radius), mm(self.0.probe.length));
        text += &format!("\n[probe]\nradius_mm = {radius}\nlength_mm = {length}\n");
        text + &unless_zero("friction", plain(self.0.probe.friction))
    }

    /// The number at a key of the phantom's file, such as `layer[1].thickness_mm`, in the unit of the key.
    pub fn number(&self, key: &str) -> Option<f64> {
        Tree::parse(&self.to_toml()).ok()?.number(key)
    }

    /// This phantom with other values at some keys of its file, each written as in the file: a number in the unit of the key, or a text
    /// in quotation marks.
    ///
    /// ```
    /// use palpate::phantom::Phantom;
    ///
    /// let phantom = Phantom::builtin("6.6")?;
    /// let thinner = phantom.set([("layer[1].thickness_mm", 14.2), ("inclusion[0].depth_mm", 6.0)])?;
    /// assert_eq!((thinner.layers()[1].thickness, thinner.inclusions()[0].depth), (0.0142, 0.006));
    /// assert_eq!(thinner.number("layer[1].thickness_mm"), Some(14.2));
    /// let error = phantom.set([("inclusion[0].depth_mm", 30)]).unwrap_err();
    /// assert!(error.to_string().starts_with("inclusion[0].depth_mm = 30.0, but must be "));
    /// assert_eq!(phantom.set([("well.walls", "\"sliding\"")])?.well().walls.to_string(), "sliding");
    /// # Ok::<(), palpate::refusal::Refusal>(())
    /// ```
    ///
    /// # Errors
    /// A key that no phantom file has, and as [`Phantom::from_toml`], without a file.
    pub fn set<K: AsRef<str>, V: Display>(
        &self,
        values: impl IntoIterator<Item = (K, V)>,
    ) -> Result<Phantom, Refusal> {
        let written = |(key, value): (K, V)| (key.as_ref().to_string(), value.to_string());
        let values: Vec<_> = values.into_iter().map(written).collect();
        let text = self.to_toml();
        let mut tree = Tree::parse(&text)?;
        for (key, value) in &values {
            tree.set(key, value)?;
        }
        // No line: nobody has the text.
        from_tree(tree).map_err(|refusal| Refusal {
            line: None,
            ..refusal
        })
    }
}

fn from_tree(mut tree: Tree) -> Result<Phantom, Refusal> {
    tree.make_list("inclusion");
    let parts = PhantomParts::from(tree.read::<PhantomFile>()?);
    Phantom::new(parts).map_err(|refusal| tree.placed(refusal))
}

fn material_lines(material: &Material) -> String {
    let (modulus, ratio) = (kpa(material.youngs_modulus), plain(material.poisson_ratio));
    format!("youngs_modulus_kpa = {modulus}\npoisson_ratio = {ratio}\n")
        + &unless_zero("yeoh_c20_kpa", kpa(material.yeoh_c20))
        + &unless_zero("fibre_modulus_kpa", kpa(material.fibre_modulus))
        + &unless_zero("fibre_angle_deg", plain(material.fibre_angle_deg))
}

/// The line of a key that need not be there.
fn unless_zero<const POWER: i32>(key: &str, number: Scaled<POWER>) -> String {
    match number.0 {
        0.0 => String::new(),
        _ => format!("{key} = {number}\n"),
    }
}

fn shape_lines(shape: &Shape) -> String {
    match shape {
        Shape::Disc { diameter } => format!("diameter_mm = {}\n", mm(*diameter)),
        Shape::Ellipse {
            width,
            height,
            angle_deg,
        } => {
            let (width, height, angle) = (mm(*width), mm(*height), plain(*angle_deg));
            format!("width_mm = {width}\nheight_mm = {height}\nangle_deg = {angle}\n")
        }
        Shape::Polygon { points } => {
            let point = |[x, y]: &[f64; 2]| format!("[{}, {}]", mm(*x), mm(*y));
            let points: Vec<_> = points.iter().map(point).collect();
            format!("points_mm = [{}]\n", points.join(", "))
        }
    }
}
