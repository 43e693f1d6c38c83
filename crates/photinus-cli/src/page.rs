//! A page for any browser, with no server: pictures one after the other, figures, and what came out.

use std::path::Path;

use photinus_io::{Error, Result};

/// How long each picture stands, ms.
const PICTURE_MS: u32 = 150;

/// What stands on a page; files are named from its folder.
pub(crate) struct Page<'a> {
    /// Its heading.
    pub(crate) title: &'a str,
    /// What came out, in lines.
    pub(crate) told: &'a str,
    /// What the pictures show.
    pub(crate) caption: &'a str,
    /// The pictures that are played.
    pub(crate) pictures: Vec<String>,
    /// Heading of the figures, and what they show.
    pub(crate) about_figures: (&'a str, &'a str),
    /// Figures, with words for those who cannot see them.
    pub(crate) figures: Vec<(String, String)>,
}

impl Page<'_> {
    /// Writes `index.html` into `folder`.
    ///
    /// # Errors
    /// [`Error`] when it cannot be written.
    pub(crate) fn write(&self, folder: &Path) -> Result<()> {
        let path = folder.join("index.html");
        std::fs::write(&path, self.text()).map_err(|error| Error::io(&path, error))
    }

    fn text(&self) -> String {
        let pictures: Vec<String> = self.pictures.iter().map(|name| format!("\"{name}\"")).collect();
        let figure = |(name, words): &(String, String)| format!("<img src=\"{name}\" alt=\"{words}\">\n");
        include_str!("page.html")
            .replace("{title}", self.title)
            .replace("{told}", self.told)
            .replace("{caption}", self.caption)
            .replace("{figures_title}", self.about_figures.0)
            .replace("{figures_caption}", self.about_figures.1)
            .replace("{figures}", &self.figures.iter().map(figure).collect::<String>())
            .replace("{picture_ms}", &PICTURE_MS.to_string())
            .replace("{pictures}", &pictures.join(",\n"))
    }
}
