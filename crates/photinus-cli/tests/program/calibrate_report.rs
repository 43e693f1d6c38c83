//! `calibrate camera --report`: the page is whole, and holds every figure that lies beside it.

use nalgebra::{Rotation3, Vector3};
use photinus::camera::Bearing;
use photinus_io::read_camera;

use crate::stage::Stage;

const CAMERA: &str = "model = \"kannala_brandt\"\nwidth_px = 752\nheight_px = 480\ncentre_px = [370.0, 235.0]\n\
                      focal_px = [265.0, 265.0]\nk = [-0.02, 0.004, 0.0, 0.0]\n";

/// The corners of a board in photos all over the image, off by a few hundredths of a pixel.
fn corners(stage: &Stage) -> String {
    stage.file("true.toml", CAMERA);
    let camera = read_camera(stage.path("true.toml")).unwrap().camera;
    let mut table = "image,u,v,grid_i,grid_j\n".to_owned();
    for photo in 0..9 {
        let (across, down) = (f64::from(photo % 3) - 1.0, f64::from(photo / 3) - 1.0);
        let turn =
            Rotation3::from_scaled_axis(Vector3::new(-0.35 * down - 0.2, 0.4 * across + 0.15, 0.3 * across));
        let middle_m = Vector3::new(0.55 * across, 0.3 * down, 0.55 + 0.05 * across);
        for (i, j) in (0..7).flat_map(|i| (0..5).map(move |j| (i, j))) {
            let led_m = Vector3::new(0.05 * (f64::from(i) - 3.0), 0.05 * (f64::from(j) - 2.0), 0.0);
            let pixel = camera.pixel(&Bearing::new(middle_m + turn * led_m).unwrap()).unwrap();
            let noise = |step: f64| 0.1 * ((f64::from(photo * 35 + i * 5 + j) * step).fract() - 0.5);
            table += &format!(
                "<{photo}>.png,{:.4},{:.4},{i},{j}\n",
                pixel.u + noise(0.618),
                pixel.v + noise(0.7549)
            );
        }
    }
    table
}

#[test]
fn the_page_holds_every_figure() {
    let stage = Stage::new("calibrate-report");
    stage.file("corners.csv", corners(&stage));
    let done = stage.run(
        "calibrate camera corners.csv --size 752x480 --grid 7x5 --model kannala-brandt --board flat --splits 2 --bootstraps 3 \
         --out solved.toml --report report",
    );
    assert_eq!(done.code, 0);
    let page = stage.read("report/index.html");
    let endings = |ending: &str| {
        let files = std::fs::read_dir(stage.path("report")).unwrap().map(|entry| entry.unwrap().path());
        files.filter(|file| file.extension().is_some_and(|end| end == ending)).count()
    };
    let figures = page.matches("<svg").count();
    assert!(figures >= 8, "{figures}");
    assert_eq!((endings("svg"), endings("png")), (figures, figures));
    for left_open in
        ["{told}", "{figures}", "{parameters}", "{photos}", "{outliers}", "kuva-clip", "NaN", "<0>"]
    {
        assert!(!page.contains(left_open), "{left_open}");
    }
    assert!(page.contains("&lt;0&gt;.png") && page.contains("focal_u_px") && page.contains("9 of 9 photos"));
}
