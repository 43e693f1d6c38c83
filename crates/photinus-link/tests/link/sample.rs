//! A frame in which everything that can be told is told.

use photinus_io::results::{FrameRecord, ResultsReader};

/// Two neighbours, one with modes and an id, one of whom only bounds are known, and a track in the dark.
const LINE: &str = r#"{"frame":17,"camera":"left","time_s":1700000000.25,"latency_s":0.0015,"source":"images/000017.png",
 "spots":[{"u_px":100.25,"v_px":50.5,"area_px":4,"peak":255,"bearing":[0.1,0.2,0.97],"bound_rad":0.002},{"u_px":10,"v_px":20,"bound_rad":0.003}],
 "neighbours":[
  {"track":4,"id":3,"id_probability":0.9999,"airframe":"hexarotor","spots":[0],"bearing":[0,0.6,0.8],
   "distance_m":{"estimate":7.25,"sigma":0.5,"min":5,"max":9,"perpendicular":7.5,"inline":5},
   "position_m":[0,4.35,5.8],"position_covariance_m2":[[0.25,0.01,0.02],[0.01,0.5,0.03],[0.02,0.03,1]],
   "orientation_xyzw":[0.5,0.5,0.5,0.5],"orientation_covariance_rad2":[[0.01,0.001,0],[0.001,0.02,0.002],[0,0.002,0.03]],
   "position_orientation_covariance_m_rad":[[0.001,0,0.002],[0,0.003,0],[0.004,0,0.005]],
   "probability":0.98,"misfit":{"chi2":2.5,"dof":3,"p":0.475},
   "velocity_m_s":[1,2,3],"velocity_covariance_m2_s2":[[1,0,0],[0,2,0],[0,0,3]],
   "modes":[{"weight":0.75,"position_m":[0,4.4,5.8],"position_covariance_m2":[[0.2,0,0],[0,0.4,0],[0,0,0.9]],"orientation_xyzw":[0,0,0,1]},
            {"weight":0.25,"position_m":[0,4.2,5.8],"position_covariance_m2":[[0.2,0,0],[0,0.4,0],[0,0,0.9]],"orientation_xyzw":[0.5,0.5,0.5,0.5],
             "orientation_covariance_rad2":[[0.01,0,0],[0,0.02,0],[0,0,0.03]]}]},
  {"airframe":"hexarotor","spots":[1],"bearing":[1,0,0],"distance_m":{"estimate":null,"sigma":null,"min":2.5,"max":null,"perpendicular":null,"inline":null}}],
 "tracks":[{"track":5,"airframe":"hexarotor","probability":0.7,"id":1,"predicted":true,"spots":[],
   "position_m":[3,0,4],"position_covariance_m2":[[0.25,0,0],[0,0.5,0],[0,0,1]],"velocity_m_s":[0,0,-1],
   "velocity_covariance_m2_s2":[[1,0,0],[0,1,0],[0,0,1]],"orientation_xyzw":[0,0,0,1],
   "orientation_covariance_rad2":[[0.01,0,0],[0,0.02,0],[0,0,0.03]]}]}"#;

/// The frame, with another number and time.
pub(crate) fn record(frame: u64, time_s: f64) -> FrameRecord {
    let line = LINE.replace('\n', " ");
    let record = ResultsReader::new(line.as_bytes(), "sample").next().expect("a line").expect("in order");
    FrameRecord { frame: Some(frame), time_s: Some(time_s), ..record }
}
