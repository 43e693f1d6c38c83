//! A scene -> frames with truth, one after the other.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use photinus_sim::recording::Taken;
use photinus_sim::{Rendered, Scene, Simulator};
use pyo3::prelude::*;

use crate::airframe::Airframe;
use crate::camera::Camera;
use crate::error::{self, SettingError, detached};
use crate::recording::Frame;

/// Frames of one camera of a scene with truth, as `photinus simulate` records them: an iterator of Frame. The same scene and seed give
/// the same frames.
#[pyclass(frozen, module = "photinus")]
pub(crate) struct Simulation {
    scene: Scene,
    camera: usize,
    frames: u64,
    state: Mutex<State>,
}

struct State {
    simulator: Simulator,
    next: u64,
}

#[pymethods]
impl Simulation {
    /// The camera that takes the frames.
    #[getter]
    fn camera(&self) -> Camera {
        Camera::new(self.scene.cameras[self.camera].camera.clone())
    }

    /// The airframe of the first target; None where there is no target.
    #[getter]
    fn airframe(&self) -> Option<Airframe> {
        self.scene.targets.first().map(|target| Airframe::new(target.airframe.clone()))
    }

    /// Frames per second.
    #[getter]
    fn rate_hz(&self) -> f64 {
        self.scene.rate_hz
    }

    /// How many frames there are, those that the recording loses among them.
    #[getter]
    fn frames(&self) -> u64 {
        self.frames
    }

    fn __iter__(this: PyRef<'_, Self>) -> PyRef<'_, Self> {
        this
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Frame>> {
        let rendered = detached(py, || {
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            Ok(self.render_next(&mut state))
        })?;
        let frame = |(rendered, taken): (Rendered, Taken)| {
            Frame::simulated(py, rendered.image, taken.gravity.into_inner().into(), taken.truth)
        };
        rendered.map(frame).transpose()
    }
}

impl Simulation {
    /// The next frame that is not lost, with the image that it carries.
    fn render_next(&self, state: &mut State) -> Option<(Rendered, Taken)> {
        while state.next < self.frames {
            let rendered = state.simulator.frame(state.next);
            let number = state.next;
            state.next += 1;
            let Some(taken) = self.scene.take(self.camera, self.frames, &rendered) else { continue };
            let shown = match taken.shown == number {
                true => rendered,
                false => state.simulator.frame(taken.shown),
            };
            return Some((shown, taken));
        }
        None
    }
}

/// Simulates a scene, a TOML file: see docs/scenes.md. `camera` names one of several; `frames` and `seed` stand in the place of the scene's.
///
/// Raises FileError when the scene is not in order, SettingError when there is no such camera or several leave a choice.
#[pyfunction]
#[pyo3(signature = (scene, *, camera = None, frames = None, seed = None))]
pub(crate) fn simulate(
    py: Python<'_>,
    scene: PathBuf,
    camera: Option<&str>,
    frames: Option<u64>,
    seed: Option<u64>,
) -> PyResult<Simulation> {
    let path = scene;
    let mut scene = detached(py, || Scene::read(&path).map_err(error::file))?;
    if let Some(seed) = seed {
        scene.set_seed(seed);
    }
    let found = match camera {
        Some(name) => scene.cameras.iter().position(|camera| camera.name == name),
        None => (scene.cameras.len() == 1).then_some(0),
    };
    let names: Vec<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    let refuse = || {
        SettingError::new_err(format!("{}: choose one of its cameras: {}", path.display(), names.join(", ")))
    };
    let camera = found.ok_or_else(refuse)?;
    let simulator = detached(py, || Ok(Simulator::new(&scene, camera)))?.ok_or_else(refuse)?;
    let (frames, state) = (frames.unwrap_or(scene.frames), Mutex::new(State { simulator, next: 0 }));
    Ok(Simulation { scene, camera, frames, state })
}
