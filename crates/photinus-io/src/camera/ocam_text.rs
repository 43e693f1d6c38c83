//! OCamCalib text: five blocks of numbers, with any number of blank and `#` lines, or none, between them.

use std::path::Path;

use nalgebra::Matrix2;
use photinus::camera::{CameraError, Model, OCam, Pixel};

use super::inverse::Curve;
use super::{CameraFile, CameraFormat, RENEW, camera_error};
use crate::{Error, Place, Result};

const BLOCKS: &str = "a calibration is, in this order: the direct and the inverse polynomial with their counts, the centre, \
                      c d e, height and width";
const COUNT: &str = "correct the count or the numbers; a comment or blank line ends a block";

/// Reads OCamCalib text; `path` is for messages.
///
/// The camera solves the inverse of the direct polynomial; the file's own inverse is only compared with it. A comment
/// `field_limit_deg = 68.5` sets the field.
///
/// # Errors
/// An [`Error`] with the line where a number, a count or a block is missing, too many or not finite, and where
/// the numbers do not make a camera.
pub fn parse_ocam_text(text: &str, path: impl AsRef<Path>) -> Result<CameraFile> {
    let path = path.as_ref();
    let mut blocks = Blocks::of(text, path);
    let direct = blocks.counted("the direct polynomial")?;
    let inverse = blocks.counted("the inverse polynomial")?;
    let centre = blocks.numbers::<2>("the centre, row then column")?;
    let affine = blocks.numbers::<3>("the affine parameters c, d, e")?;
    let size = blocks.numbers::<2>("the image size, height then width")?;
    if let Some(row) = blocks.rows.next() {
        let reason = "more numbers after the five blocks of a calibration".to_owned();
        return Err(blocks.wrong(row.line, reason, BLOCKS));
    }
    let [height_px, width_px] = [side(path, &size, 0)?, side(path, &size, 1)?];

    let [c, d, e] = affine.values;
    let lens =
        OCam::new(&direct.values, Pixel::new(centre.values[1], centre.values[0]), Matrix2::new(c, d, e, 1.0))
            .map_err(|error| {
                let line =
                    if matches!(error, CameraError::Singular { .. }) { affine.line } else { direct.line };
                camera_error(path, error).at(Place::Line(line))
            })?;
    let model = Model::OCam(lens.clone());
    let field_limit_deg = field_limit_deg(text, path)?;
    let mut file = CameraFile::new(CameraFormat::OcamText, model, [width_px, height_px], field_limit_deg)
        .map_err(|error| {
            let line = if matches!(error, CameraError::Size { .. }) { size.line } else { direct.line };
            camera_error(path, error).at(Place::Line(line))
        })?;
    file.remark_lens(&lens);
    file.compare_inverse(&lens, &inverse.values);
    Ok(file)
}

impl CameraFile {
    /// Remarks on what an OCam lens seldom has.
    pub(super) fn remark_lens(&mut self, lens: &OCam) {
        let cone = lens.direct().get(1).copied().unwrap_or(0.0);
        if cone.abs() > 1e-9 {
            self.oddities.push(format!(
                "term 1 of the direct polynomial is {cone}, not 0: a lens with a tip on its axis"
            ));
        }
        let bend = (lens.stretch() - Matrix2::identity()).abs().max();
        if bend > 0.05 {
            self.oddities
                .push(format!("the affine part is {bend:.3} from the identity: pixels that are not square?"));
        }
    }

    /// Compares the file's inverse polynomial with the solved inverse.
    pub(super) fn compare_inverse(&mut self, lens: &OCam, inverse: &[f64]) {
        let report = Curve::of(&self.camera, lens).report(inverse);
        self.inverse = Some(report);
        // in total order NaN, from a polynomial that overflows, is the largest
        if report.max_px.total_cmp(&0.05).is_gt() {
            self.oddities.push(format!(
                "the inverse polynomial disagrees: it is {report}, most at {:.1} deg off the axis; Photinus uses the direct one",
                report.worst_rad.to_degrees()
            ));
        }
    }
}

/// A line that holds numbers.
struct Row<'a> {
    line: usize,
    words: Vec<&'a str>,
}

/// A block's values, and the line where it begins.
struct Block<T> {
    line: usize,
    values: T,
}

/// The lines that hold numbers, in order.
struct Blocks<'a> {
    path: &'a Path,
    rows: std::iter::Peekable<std::vec::IntoIter<Row<'a>>>,
    last_line: usize,
}

impl<'a> Blocks<'a> {
    fn of(text: &'a str, path: &'a Path) -> Self {
        let words = |line: &'a str| line.split('#').next().unwrap_or_default().split_whitespace().collect();
        let rows: Vec<_> = text
            .lines()
            .enumerate()
            .map(|(index, line)| Row { line: index + 1, words: words(line) })
            .filter(|row| !row.words.is_empty())
            .collect();
        Self { path, rows: rows.into_iter().peekable(), last_line: text.lines().count().max(1) }
    }

    /// A count, then that many numbers.
    fn counted(&mut self, what: &str) -> Result<Block<Vec<f64>>> {
        let mut row = self.row(what)?;
        let word = row.words.remove(0);
        let count = word.parse::<usize>().ok().filter(|count| (1..=OCam::MAX_COEFFICIENTS).contains(count));
        let Some(count) = count else {
            let reason = format!(
                "`{word}` where the number of coefficients of {what} is expected, 1 to {}",
                OCam::MAX_COEFFICIENTS
            );
            return Err(self.wrong(row.line, reason, "begin the block with how many numbers follow"));
        };
        self.values(row, what, count)
    }

    /// Exactly `N` numbers.
    fn numbers<const N: usize>(&mut self, what: &str) -> Result<Block<[f64; N]>> {
        let row = self.row(what)?;
        let Block { line, values } = self.values(row, what, N)?;
        let values =
            values.try_into().map_err(|_| self.wrong(line, format!("{what}: not {N} numbers"), BLOCKS))?;
        Ok(Block { line, values })
    }

    /// `count` numbers from `row`, and from the lines that follow it at once while they are too few.
    fn values(&mut self, mut row: Row<'a>, what: &str, count: usize) -> Result<Block<Vec<f64>>> {
        let line = row.line;
        let mut values = Vec::with_capacity(count);
        loop {
            for word in &row.words {
                values.push(self.finite(row.line, word, what)?);
            }
            if values.len() >= count {
                break;
            }
            let next_line = row.line + 1;
            let short = format!("{what}: {} numbers where {count} are expected", values.len());
            row = self
                .rows
                .next_if(|next| next.line == next_line)
                .ok_or_else(|| self.wrong(line, short, COUNT))?;
        }
        if values.len() > count {
            let reason = format!("{what}: {} numbers where {count} are expected", values.len());
            return Err(self.wrong(row.line, reason, COUNT));
        }
        Ok(Block { line, values })
    }

    fn row(&mut self, what: &str) -> Result<Row<'a>> {
        self.rows
            .next()
            .ok_or_else(|| self.wrong(self.last_line, format!("the file ends before {what}"), BLOCKS))
    }

    fn finite(&self, line: usize, word: &str, what: &str) -> Result<f64> {
        word.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
            let reason = format!("`{word}` where a finite number of {what} is expected");
            self.wrong(line, reason, RENEW)
        })
    }

    fn wrong(&self, line: usize, reason: String, advice: &str) -> Error {
        Error::format(self.path, reason).at(Place::Line(line)).advise(advice)
    }
}

/// A side of the image.
fn side(path: &Path, size: &Block<[f64; 2]>, index: usize) -> Result<usize> {
    let value = size.values[index];
    if value.fract().abs() > 0.0 || !(0.0..=1e6).contains(&value) {
        let reason = "the image size: whole numbers of pixels are expected, height then width";
        let advice = "give the size of the images that the camera was calibrated with, such as 480 752";
        return Err(Error::format(path, reason).at(Place::Line(size.line)).advise(advice));
    }
    Ok(value as usize)
}

/// The field limit from a comment `field_limit_deg = 68.5`.
fn field_limit_deg(text: &str, path: &Path) -> Result<Option<f64>> {
    for (index, line) in text.lines().enumerate() {
        let comment = line.split_once('#').map(|(_, comment)| comment).unwrap_or_default();
        let Some((_, rest)) = comment.split_once("field_limit_deg") else { continue };
        let word = rest.trim_start_matches([' ', '=', ':']).split_whitespace().next().unwrap_or_default();
        let limit = word.parse().ok().filter(|limit: &f64| limit.is_finite());
        let reason = format!("`{word}` where field_limit_deg is expected, a number of degrees");
        let advice = "write # field_limit_deg = 68.5, or leave it out";
        return limit
            .map(Some)
            .ok_or_else(|| Error::format(path, reason).at(Place::Line(index + 1)).advise(advice));
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "#direct polynomial\n\n5 -2.595395e+02 0 1.626945e-03 -2.328091e-06 6.601777e-09\n\n#inverse\n\n\
        10 388.557547 220.910537 -10.127377 31.174444 16.299989 0.874110 31.882430 44.770601 21.586002 3.593416\n\n\
        #centre\n\n229.581672 364.430465\n\n#affine\n\n1.000314 -0.000012 -0.000158\n\n#size\n\n480 752\n";

    fn read(text: &str) -> Result<CameraFile> {
        parse_ocam_text(text, Path::new("cam.txt"))
    }

    fn refusal(text: &str) -> String {
        read(text).unwrap_err().to_string()
    }

    #[test]
    fn the_blocks_are_found_whatever_lies_between() {
        let camera = read(FILE).unwrap().camera;
        assert_eq!((camera.width(), camera.height()), (752, 480));
        assert_eq!(camera.model().centre(), Pixel::new(364.430465, 229.581672));
        let bare: String =
            FILE.lines().filter(|l| !l.starts_with('#') && !l.is_empty()).collect::<Vec<_>>().join("\n");
        let chatty = FILE.replace('\n', " # so\r\n\r\n# more\r\n").replace("## more", "# more");
        for text in [bare, FILE.replace('\n', "\r\n"), chatty, FILE.replace(" 31.174444 ", "\n31.174444 ")] {
            assert_eq!(read(&text).unwrap().camera, camera, "{text}");
        }
    }

    #[test]
    fn what_is_missing_or_too_much_is_refused_with_its_line() {
        let cases = [
            (
                FILE.replacen("5 -2", "6 -2", 1),
                "cam.txt, line 3: the direct polynomial: 5 numbers where 6 are expected",
            ),
            (
                FILE.replacen("5 -2", "4 -2", 1),
                "cam.txt, line 3: the direct polynomial: 5 numbers where 4 are expected",
            ),
            (FILE.replacen("5 -2", "x -2", 1), "cam.txt, line 3: `x` where the number of coefficients"),
            (FILE.replacen("5 -2", "999999999999 -2", 1), "cam.txt, line 3: `999999999999` where"),
            (
                FILE.replace("1.626945e-03", "nan"),
                "cam.txt, line 3: `nan` where a finite number of the direct",
            ),
            (
                FILE.replace("31.174444", "1e400"),
                "cam.txt, line 7: `1e400` where a finite number of the inverse",
            ),
            (
                FILE.replace("229.581672 ", ""),
                "cam.txt, line 11: the centre, row then column: 1 numbers where 2",
            ),
            (FILE.replace("480 752\n", ""), "cam.txt, line 18: the file ends before the image size"),
            (format!("{FILE}1 2 3\n"), "cam.txt, line 20: more numbers after the five blocks"),
            (FILE.replace("480 752", "480.5 752"), "cam.txt, line 19: the image size: whole numbers"),
            (FILE.replace("480 752", "-480 752"), "cam.txt, line 19: the image size: whole numbers"),
            (FILE.replace("480 752", "480 1e300"), "cam.txt, line 19: the image size: whole numbers"),
            (FILE.replace("480 752", "480 0"), "cam.txt, line 19: an image of 0x480 pixels"),
            (
                FILE.replace("1.000314 -0.000012 -0.000158", "1 1 1"),
                "cam.txt, line 15: the affine matrix cannot",
            ),
            (
                FILE.replace("-2.595395e+02", "2.595395e+02"),
                "cam.txt, line 3: term 0 of the direct polynomial is 259",
            ),
            (
                FILE.replace("6.601777e-09", "-6.601777e-08"),
                "cam.txt, line 3: the angle off the axis stops growing at",
            ),
        ];
        for (text, message) in cases {
            assert!(refusal(&text).starts_with(message), "{}\nnot {message}", refusal(&text));
        }
    }

    #[test]
    fn a_comment_sets_the_field() {
        let limited = read(&format!("# field_limit_deg = 68.5\n{FILE}")).unwrap().camera;
        assert!((limited.field_limit_rad().to_degrees() - 68.5).abs() < 1e-12);
        assert!(
            refusal(&format!("# field_limit_deg = wide\n{FILE}"))
                .contains("line 1: `wide` where field_limit_deg")
        );
        assert!(refusal(&format!("# field_limit_deg = 400\n{FILE}")).contains("a field limit of 400 deg"));
    }

    #[test]
    fn an_inverse_that_disagrees_is_an_oddity() {
        let good = read(FILE).unwrap();
        assert!(good.oddities.is_empty() && good.inverse.unwrap().max_px < 0.05, "{:?}", good.inverse);
        let odd = read(&FILE.replace("388.557547", "389.557547")).unwrap();
        assert!(odd.oddities[0].contains("is up to 1.0"), "{:?}", odd.oddities);
        let wild = read(&FILE.replace("388.557547", "1e308")).unwrap();
        assert!(
            wild.oddities[0].contains("is more than 10000 px from the direct one"),
            "{:?}",
            wild.oddities
        );
        let centre = read(&FILE.replace("229.581672", "29.581672").replace("6.601777e-09", "4e-09")).unwrap();
        assert!(centre.oddities[0].contains("far from the middle"), "{:?}", centre.oddities);
    }
}
