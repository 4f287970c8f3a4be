//! A figure as data, and how it is drawn.

use crate::report::text::FileNames;
use crate::report::{Figure, Topic};
use palpate::chart::{Panel, chart, with_head};
use palpate::refusal::Refusal;

/// Title, caption and alternative text, as of [`Figure`].
pub type Words = [String; 3];

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

/// What is drawn.
pub enum Picture {
    /// Panels below one another.
    Panels(Vec<Panel>),
    /// A finished SVG document, and its height, pixels.
    Finished(&'static str, i32),
}

impl Plan {
    /// A figure with one file name whatever the run holds.
    pub fn new(id: impl Into<String>, topic: Topic, words: Words, picture: Picture) -> Plan {
        Plan {
            id: id.into(),
            name: String::new(),
            topic,
            words,
            picture,
        }
    }

    /// The figure, drawn, with a file name that `names` does not have yet.
    ///
    /// # Errors
    /// Drawing fails.
    pub fn draw(self, names: &mut FileNames) -> Result<Figure, Refusal> {
        let file_name = names.unique(&self.id, &self.name, "svg");
        let [title, caption, alt] = self.words;
        let head = [&*file_name, &title, &alt];
        let svg = match &self.picture {
            Picture::Panels(panels) => chart(panels, head)?,
            Picture::Finished(svg, height) => with_head(svg, *height, head)?,
        };
        Ok(Figure {
            file_name,
            topic: self.topic,
            title,
            caption,
            alt,
            svg,
        })
    }
}

/// `panels` below one another over one x axis.
pub fn over(x_name: &str, panels: impl Into<Vec<Panel>>) -> Picture {
    let mut panels = panels.into();
    if let Some(last) = panels.last_mut() {
        last.x_name = x_name.into();
    }
    Picture::Panels(panels)
}
