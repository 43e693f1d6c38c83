//! From the text of an SVG to pixels: the same picture, its words in the font inside the program, whatever the machine has.

use std::sync::Arc;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb::Database};

/// The longest side of a picture, px: a figure that would be larger is drawn smaller.
const LONGEST_PX: f32 = 8192.0;

/// The bytes of a PNG of the figure in `svg`, `scale` pixels for one of the SVG, on white.
///
/// # Errors
/// What is wrong with the text, or that there is no memory for this many pixels.
pub(super) fn png(svg: &str, scale: f32) -> Result<Vec<u8>, String> {
    let tree = Tree::from_str(svg, &options()).map_err(|error| error.to_string())?;
    let size = tree.size();
    let scale = scale.min(LONGEST_PX / size.width().max(size.height()));
    let pixels = |side: f32| ((side * scale).round() as u32).max(1);
    let mut picture = Pixmap::new(pixels(size.width()), pixels(size.height()))
        .ok_or_else(|| "no memory for a picture of this size".to_owned())?;
    picture.fill(Color::WHITE);
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut picture.as_mut());
    picture.encode_png().map_err(|error| error.to_string())
}

/// DejaVu Sans for every word, and no font of the machine.
fn options() -> Options<'static> {
    const FAMILY: &str = "DejaVu Sans";
    let mut fonts = Database::new();
    for face in [dejavu::sans::regular(), dejavu::sans::bold()] {
        fonts.load_font_data(face.to_vec());
    }
    fonts.set_serif_family(FAMILY);
    fonts.set_sans_serif_family(FAMILY);
    fonts.set_monospace_family(FAMILY);
    Options { font_family: FAMILY.to_owned(), fontdb: Arc::new(fonts), ..Options::default() }
}

#[cfg(test)]
mod tests {
    use photinus_io::image::{GreyImage, decode_image};

    use super::*;

    fn drawn(content: &str, scale: f32) -> GreyImage {
        let svg =
            format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"60\" height=\"40\">{content}</svg>");
        decode_image(&png(&svg, scale).unwrap(), "t").unwrap().image
    }

    fn ink_px(image: &GreyImage) -> usize {
        image.pixels().iter().filter(|&&level| level < 128).count()
    }

    #[test]
    fn words_show_whatever_font_they_ask_for() {
        let words = |family: &str| {
            format!("<text x=\"5\" y=\"30\" font-size=\"20\" font-family=\"{family}\">mm</text>")
        };
        let ours = drawn(&words("DejaVu Sans"), 2.0);
        assert_eq!((ours.width(), ours.height()), (120, 80));
        assert!((200..2000).contains(&ink_px(&ours)), "{}", ink_px(&ours));
        assert_eq!(drawn(&words("Arial, sans-serif"), 2.0), ours);
        assert_eq!(drawn(&words("no such font"), 2.0), ours);
        assert_eq!(ink_px(&drawn("", 2.0)), 0);
    }

    #[test]
    fn a_picture_has_a_bound() {
        let image = drawn("<rect x=\"0\" y=\"0\" width=\"30\" height=\"40\"/>", 1e6);
        assert_eq!((image.width(), image.height()), (8192, 5461));
        assert_eq!(ink_px(&image), 4096 * 5461);
    }

    #[test]
    fn what_is_no_svg_is_refused() {
        assert!(png("<svg", 1.0).is_err());
    }
}
