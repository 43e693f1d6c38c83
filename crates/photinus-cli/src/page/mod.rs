//! Pages for any browser, with no server, light and dark, wide and narrow: enters words, figures and pictures, leaves one
//! `index.html`.
//!
//! ```text
//! style.css  how every page looks
//! player     pictures one after the other, with a cursor in time
//! timeline   a distance over that time, drawn in the page itself
//! ```

mod player;
mod timeline;

use std::path::Path;

use photinus_io::{Error, Result};

pub(crate) use player::{Player, Shot};
pub(crate) use timeline::{Moment, Timeline};

/// A page in the making.
pub(crate) struct Page {
    title: String,
    body: String,
    script: &'static str,
}

impl Page {
    /// A page that holds nothing but its heading.
    pub(crate) fn new(title: &str) -> Self {
        Self { title: escaped(title), body: String::new(), script: "" }
    }

    /// A paragraph.
    pub(crate) fn text(mut self, text: &str) -> Self {
        self.body += &format!("<p>{}</p>\n", escaped(text));
        self
    }

    /// A heading.
    pub(crate) fn heading(mut self, text: &str) -> Self {
        self.body += &format!("<h2>{}</h2>\n", escaped(text));
        self
    }

    /// A heading that [`Page::contents`] leads to.
    pub(crate) fn chapter(mut self, anchor: &str, text: &str) -> Self {
        self.body += &format!("<h2 id=\"{}\">{}</h2>\n", escaped(anchor), escaped(text));
        self
    }

    /// What is on the page: anchors and texts of its chapters.
    pub(crate) fn contents(mut self, chapters: &[(String, String)]) -> Self {
        let item = |(anchor, text): &(String, String)| {
            format!("<li><a href=\"#{}\">{}</a></li>\n", escaped(anchor), escaped(text))
        };
        self.body += &format!("<nav><ul>\n{}</ul></nav>\n", chapters.iter().map(item).collect::<String>());
        self
    }

    /// Lines whose columns stand below each other.
    pub(crate) fn lines(mut self, text: &str) -> Self {
        self.body += &format!("<pre>{}</pre>\n", escaped(text));
        self
    }

    /// What is HTML already.
    pub(crate) fn html(mut self, html: &str) -> Self {
        self.body += html;
        self.body.push('\n');
        self
    }

    /// Files to go on with: name, and what is in it.
    pub(crate) fn links(mut self, links: &[(&str, &str)]) -> Self {
        let item = |(file, what): &(&str, &str)| {
            format!("<li><a href=\"{0}\">{0}</a>: {1}</li>\n", escaped(file), escaped(what))
        };
        self.body += &format!("<ul>\n{}</ul>\n", links.iter().map(item).collect::<String>());
        self
    }

    /// A figure in a file beside the page, whose title is drawn in it.
    pub(crate) fn figure(self, file: &str, title: &str, caption: &str) -> Self {
        let image = format!(
            "<img class=\"plot\" src=\"{}\" alt=\"{}\" loading=\"lazy\">",
            escaped(file),
            escaped(title)
        );
        self.drawn(&image, caption)
    }

    /// A figure whose SVG stands in the page itself; `name` tells it apart from others.
    pub(crate) fn svg(self, svg: &str, name: &str, caption: &str) -> Self {
        // Names of clip paths would be the same in every figure of the page.
        let svg = svg.replace("kuva-clip-", &format!("{name}-"));
        self.drawn(&svg, caption)
    }

    fn drawn(mut self, drawn: &str, caption: &str) -> Self {
        let caption = escaped(caption);
        self.body += &format!("<figure>\n{drawn}\n<figcaption>{caption}</figcaption>\n</figure>\n");
        self
    }

    /// Pictures that are played.
    pub(crate) fn player(mut self, player: &Player) -> Self {
        self.body += &player.html();
        self.script = player::SCRIPT;
        self
    }

    /// What moves what is HTML already.
    pub(crate) fn script(self, script: &'static str) -> Self {
        Self { script, ..self }
    }

    /// Writes `index.html` into `folder`.
    ///
    /// # Errors
    /// [`Error`] when it cannot be written.
    pub(crate) fn write(&self, folder: &Path) -> Result<()> {
        let path = folder.join("index.html");
        std::fs::write(&path, self.whole()).map_err(|error| Error::io(&path, error))
    }

    fn whole(&self) -> String {
        let script = match self.script {
            "" => String::new(),
            script => format!("<script>\n{script}</script>\n"),
        };
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>Photinus: {0}</title>\n\
             <style>\n{1}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n{2}</main>\n{script}</body>\n</html>\n",
            self.title,
            include_str!("style.css"),
            self.body,
        )
    }
}

/// Text that holds no mark-up.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_no_markup() {
        assert_eq!(escaped("a<b>&\"c\".png"), "a&lt;b&gt;&amp;&quot;c&quot;.png");
        let page =
            Page::new("<x>").text("a & b").figure("<f>.svg", "<t>", "<c>").links(&[("<l>", "<w>")]).whole();
        for (tag, count) in
            [("<x>", 0), ("<f>", 0), ("<t>", 0), ("<c>", 0), ("<l>", 0), ("<figure>", 1), ("<script>", 0)]
        {
            assert_eq!(page.matches(tag).count(), count, "{tag}");
        }
        assert!(page.contains("a &amp; b") && page.contains("width=device-width"));
    }

    #[test]
    fn figures_of_a_page_keep_their_own_clip_paths() {
        let svg = "<svg><clipPath id=\"kuva-clip-0\"/></svg>";
        let page = Page::new("t").svg(svg, "one", "").svg(svg, "two", "").whole();
        assert!(
            page.contains("id=\"one-0\"") && page.contains("id=\"two-0\"") && !page.contains("kuva-clip")
        );
    }
}
