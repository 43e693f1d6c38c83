//! Pictures that a page plays, and timelines beneath them whose cursor moves along.

use std::fmt::Write;

use super::{Timeline, escaped};

/// What moves the pictures and the cursor.
pub(super) const SCRIPT: &str = include_str!("player.js");

/// A picture, and when its frame was taken.
pub(crate) struct Shot {
    /// Its file, from the folder of the page.
    pub(crate) file: String,
    /// When, s.
    pub(crate) time_s: f64,
}

/// Pictures with what goes with them.
pub(crate) struct Player {
    /// What the pictures show.
    pub(crate) caption: String,
    /// The pictures, in order of time.
    pub(crate) shots: Vec<Shot>,
    /// What is drawn over the same time.
    pub(crate) timelines: Vec<Timeline>,
}

impl Player {
    pub(super) fn html(&self) -> String {
        let shots: Vec<serde_json::Value> = self
            .shots
            .iter()
            .map(|shot| serde_json::json!({ "file": shot.file, "time_s": shot.time_s }))
            .collect();
        // Nothing in JSON may end the element that it stands in.
        let shots = serde_json::Value::from(shots).to_string().replace('<', "\\u003c");
        let mut html = format!(
            "<section class=\"player\">\n<p class=\"caption\">{}</p>\n\
             <div class=\"picture\"><img alt=\"A frame with what was found in it, and the same from above\"></div>\n\
             <div class=\"controls\"><button>Pause</button>\
             <input type=\"range\" min=\"0\" value=\"0\" aria-label=\"Picture\"><output></output></div>\n",
            escaped(&self.caption)
        );
        self.timelines.iter().for_each(|timeline| timeline.write(&mut html));
        // Writing to a String cannot fail.
        let _ = write!(html, "<script type=\"application/json\">{shots}</script>\n</section>\n");
        html
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_is_named_with_its_time() {
        let shot = |file: &str, time_s| Shot { file: file.to_owned(), time_s };
        let shots = vec![shot("a.png", 0.5), shot("</script>.png", 1.5)];
        let html = Player { caption: "<c>".to_owned(), shots, timelines: Vec::new() }.html();
        assert!(
            html.contains(r#"[{"file":"a.png","time_s":0.5},{"file":"\u003c/script>.png","time_s":1.5}]"#),
            "{html}"
        );
        assert!(html.contains("&lt;c&gt;") && html.matches("</script>").count() == 1);
    }
}
