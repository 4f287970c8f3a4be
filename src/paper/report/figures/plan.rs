//! A figure as data, and how it is drawn.

use crate::report::text::FileNames;
use crate::report::{Figure, Topic};
use palpate::chart::{Panel, chart, with_head};
use palpate::refusal::Refusal;

/// A figure before it is drawn.
pub struct Plan {
    /// What its file name begins with,
    pub id: String,
    /// and an untrusted name that it goes on with, which may be empty.
    pub name: String,
    /// Where on the page it stands.
    pub topic: Topic,
    /// What is said of it.
    pub words: Words,
    /// What is drawn.
    pub picture: Picture,
}

/// The words around a picture.
pub struct Words {
    /// As of [`Figure`].
    pub title: String,
    /// As of [`Figure`].
    pub caption: String,
    /// As of [`Figure`].
    pub alt: String,
}

/// What is drawn.
pub enum Picture {
    /// Panels below one another over one x axis with a name.
    Panels(Vec<Panel>, String),
    /// A finished SVG document, and its height, pixels.
    Finished(&'static str, i32),
}

impl Words {
    /// The words around a picture.
    pub fn new(
        title: impl Into<String>,
        caption: impl Into<String>,
        alt: impl Into<String>,
    ) -> Words {
        let (title, caption, alt) = (title.into(), caption.into(), alt.into());
        Words {
            title,
            caption,
            alt,
        }
    }
}

impl Plan {
    /// A figure of `panels` below one another over an x axis with a name.
    pub fn new(id: &str, topic: Topic, words: Words, panels: Vec<Panel>, x_name: &str) -> Plan {
        Plan {
            id: id.into(),
            name: String::new(),
            topic,
            words,
            picture: Picture::Panels(panels, x_name.into()),
        }
    }

    /// The figure, drawn, with a file name that `names` does not have yet.
    ///
    /// # Errors
    /// Drawing fails.
    pub fn draw(self, names: &mut FileNames) -> Result<Figure, Refusal> {
        let file_name = names.unique(&self.id, &self.name, "svg");
        let Words {
            title,
            caption,
            alt,
        } = self.words;
        let drawn = match self.picture {
            Picture::Panels(panels, x_name) => chart(&panels, &x_name),
            Picture::Finished(svg, height) => Ok((svg.into(), height)),
        };
        let svg = drawn.and_then(|drawn| with_head(drawn, &file_name, &title, &alt));
        let svg = svg.map_err(Refusal::because(format!("figure {title:?}")))?;
        let topic = self.topic;
        Ok(Figure {
            file_name,
            topic,
            title,
            caption,
            alt,
            svg,
        })
    }
}
