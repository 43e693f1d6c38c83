//! Frames in which something else than points is bright: beforehand, there may be points of clutter, too, above all beside it.

use super::*;
use crate::frame::FrameView;

const LEVEL: u8 = 5;
const SIZE: [usize; 2] = [752, 480];

/// A frame with the light of LEDs at these places, and bright bars whose first pixels are at those.
fn frame(leds: &[[f64; 2]], bars: &[[usize; 2]]) -> Vec<u8> {
    let mut pixels = vec![LEVEL; SIZE[0] * SIZE[1]];
    for &[left, top] in bars {
        for v in top..top + 3 {
            pixels[v * SIZE[0] + left..][..40].fill(200);
        }
    }
    for &[u, v] in leds {
        for y in v as usize - 4..v as usize + 5 {
            for x in u as usize - 4..u as usize + 5 {
                let r2 = (x as f64 - u).powi(2) + (y as f64 - v).powi(2);
                pixels[y * SIZE[0] + x] += (150.0 * libm::exp(-0.5 * r2 / 0.64)) as u8;
            }
        }
    }
    pixels
}

/// Twenty bars, spread over the left half of the frame or close together from a place on.
fn bars(place: Option<[usize; 2]>) -> Vec<[usize; 2]> {
    (0..20)
        .map(|bar| match place {
            None => [10 + 60 * (bar % 5), 20 + 110 * (bar / 5)],
            Some([u, v]) => [u + 44 * (bar % 2), v + 6 * (bar / 2)],
        })
        .collect()
}

fn locator() -> Locator {
    let settings = Settings { min_probability: 0.0, ..Settings::default() };
    Locator::new(camera(), &hexarotor(), None, settings).unwrap()
}

/// How likely the likeliest neighbour is.
fn likeliest(locator: &mut Locator, pixels: &[u8]) -> f64 {
    let view = FrameView::new(pixels, SIZE[0], SIZE[1], SIZE[0]).unwrap();
    let located = locator.locate(Input::frame(&view).gravity(Some(&level()))).unwrap();
    located.neighbours.iter().map(|neighbour| neighbour.probability).fold(0.0, f64::max)
}

/// The same in a first frame.
fn at_first(leds: &[[f64; 2]], bars: &[[usize; 2]]) -> f64 {
    likeliest(&mut locator(), &frame(leds, bars))
}

fn odds(probability: f64) -> f64 {
    probability / (1.0 - probability)
}

const PAIR: [[f64; 2]; 2] = [[600.3, 200.4], [621.6, 201.2]];

#[test]
fn points_in_a_frame_of_other_bright_things_may_be_some_of_them() {
    let [dark, among, beside] =
        [vec![], bars(None), bars(Some([560, 215]))].map(|bars| at_first(&PAIR, &bars));
    assert!(odds(dark) > 100.0 * odds(among), "{dark} in the dark, {among} among bars");
    assert!(odds(among) > 100.0 * odds(beside), "{among} among bars, {beside} beside them");
}

#[test]
fn that_bars_brought_no_points_in_the_frames_before_counts_more() {
    let mut locator = locator();
    for _ in 0..64 {
        assert!(likeliest(&mut locator, &frame(&[], &bars(None))) == 0.0);
    }
    let (first, later) = (at_first(&PAIR, &bars(None)), likeliest(&mut locator, &frame(&PAIR, &bars(None))));
    assert!(odds(later) > 10.0 * odds(first), "{later}, {first} in a first frame");
}

#[test]
fn a_neighbour_that_shows_three_markers_is_one_wherever_it_is() {
    let placed = Placed::new(ahead(4.0, 0.5, 0.0), 0.1, Vector3::zeros());
    let spots = placed.spots(&hexarotor(), &camera(), &mut Pcg64::new(7, 1));
    let leds: Vec<[f64; 2]> = spots.iter().map(|spot| [spot.centre.u, spot.centre.v]).collect();
    assert!(leds.len() >= 3);
    let among = at_first(&leds, &bars(None));
    assert!(among > 0.98, "{among}");
}
