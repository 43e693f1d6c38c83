//! The page in a real browser, headless Chromium, driven through its debugging port: it shows frames as they come, pauses, goes back, and fits a phone.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use photinus_io::frames::{Frame, Moved};
use photinus_io::image::GreyImage;
use photinus_io::results::{FrameRecord, ResultsReader};
use photinus_page::Page;
use photinus_run::Entry;
use photinus_run::config::PageAddress;
use photinus_run::health::{Level, Notice};
use photinus_run::sink::Sink;
use photinus_testing::Skipped;
use serde_json::{Value, json};
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// A browser with one page, gone with the value.
struct Browser {
    child: Child,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    session: Option<Value>,
    next: u64,
}

impl Browser {
    /// Debian's Chromium, or that of `PHOTINUS_CHROMIUM`; `None` where there is none.
    fn start() -> Option<Self> {
        let program = std::env::var("PHOTINUS_CHROMIUM").unwrap_or("chromium".to_owned());
        let words =
            ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", "about:blank"];
        let profile = format!(
            "--user-data-dir={}",
            std::env::temp_dir().join(format!("photinus-page-{}", std::process::id())).display()
        );
        let mut child = Command::new(program).args(words).arg(profile).stderr(Stdio::piped()).spawn().ok()?;
        let lines = BufReader::new(child.stderr.take()?).lines();
        let address = lines
            .map_while(Result::ok)
            .find_map(|line| Some(line.strip_prefix("DevTools listening on ")?.to_owned()))?;
        let (socket, _) = tungstenite::connect(address).ok()?;
        let mut browser = Self { child, socket, session: None, next: 0 };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }))["targetId"].clone();
        let attached = browser.call("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        browser.session = Some(attached["sessionId"].clone());
        Some(browser)
    }

    fn call(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let mut message = json!({ "id": self.next, "method": method, "params": params });
        if let Some(session) = &self.session {
            message["sessionId"] = session.clone();
        }
        self.socket.send(Message::text(message.to_string())).unwrap();
        loop {
            let answer = self.socket.read().unwrap();
            let answer: Value = serde_json::from_str(answer.to_text().unwrap_or("null")).unwrap_or_default();
            if answer["id"] == self.next {
                assert!(answer["error"].is_null(), "{method}: {answer}");
                return answer["result"].clone();
            }
        }
    }

    fn ask(&mut self, script: &str) -> Value {
        let answer = self.call("Runtime.evaluate", json!({ "expression": script, "returnByValue": true }));
        assert!(answer["exceptionDetails"].is_null(), "{script}: {answer}");
        answer["result"]["value"].clone()
    }

    /// Waits until a script is true.
    fn wait_for(&mut self, script: &str) {
        let until = Instant::now() + Duration::from_secs(60);
        while self.ask(script) != true {
            assert!(Instant::now() < until, "{script} never came: {}", self.ask("document.body.innerText"));
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    fn size(&mut self, width: u32, height: u32) {
        let metrics =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500 });
        self.call("Emulation.setDeviceMetricsOverride", metrics);
    }

    /// Nothing is wider than the window.
    fn fits(&mut self) -> bool {
        self.ask("document.documentElement.scrollWidth <= window.innerWidth") == true
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A neighbour that flies past, `index` frames after the first.
fn entry(camera: usize, index: u64) -> Entry {
    let u_px = 200.0 + index as f64 % 300.0;
    let name = ["left", "right"][camera];
    let at_m = [6.0, 2.0 - 0.01 * (index % 300) as f64, 0.0];
    let line = json!({
        "frame": index, "camera": name, "time_s": index as f64 / 60.0, "latency_s": 0.0012,
        "spots": [{ "u_px": u_px, "v_px": 200 }, { "u_px": u_px + 20.0, "v_px": 203 }],
        "rejected": [{ "u_px": 600, "v_px": 100, "area_px": 900, "reason": "sun" }],
        "neighbours": [{ "track": 4, "id": 7, "airframe": "hexa", "spots": [0, 1], "bearing": [0, 0, 1], "probability": 0.98,
            "distance_m": { "estimate": 6.3, "sigma": 0.2, "min": 5.1, "max": 8.4, "perpendicular": null, "inline": null },
            "position_m": [0, 0, 6.3], "position_covariance_m2": [[0.01, 0, 0], [0, 0.01, 0], [0, 0, 0.04]],
            "position_body_m": at_m, "position_body_covariance_m2": [[0.09, 0.02, 0], [0.02, 0.01, 0], [0, 0, 0.01]] }],
        "tracks": [{ "track": 4, "id": 7, "airframe": "hexa", "probability": 0.99, "predicted": false, "spots": [0, 1], "position_m": [0, 0, 6.3],
            "position_covariance_m2": [[0.01, 0, 0], [0, 0.01, 0], [0, 0, 0.04]], "position_body_m": at_m,
            "position_body_covariance_m2": [[0.09, 0.02, 0], [0.02, 0.01, 0], [0, 0, 0.01]], "velocity_m_s": [0, 0, 0],
            "velocity_covariance_m2_s2": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "orientation_xyzw": [0, 0, 0, 1],
            "orientation_covariance_rad2": [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }]
    });
    let record: FrameRecord = ResultsReader::new(line.to_string().as_bytes(), "t").next().unwrap().unwrap();
    let mut pixels = vec![12; 752 * 480];
    for (v, u) in (198..206).flat_map(|v| (0..30).map(move |u| (v, u))) {
        pixels[v * 752 + u_px as usize + u] = if u % 20 < 6 { 250 } else { 12 };
    }
    let image = GreyImage::new(pixels, 752, 480).unwrap();
    let frame = Frame {
        image,
        index,
        time_s: record.time_s,
        source: "t".to_owned(),
        gravity: None,
        exposure_s: None,
        moved: Moved::default(),
        conversions: Vec::new(),
    };
    Entry { record, camera, exposure_s: Some(1e-3), ..Entry::from_frame(frame) }
}

#[test]
fn a_browser_shows_what_comes_pauses_goes_back_and_fits_a_phone() {
    let _others = crate::MEMORY.read();
    let Some(mut browser) = Browser::start() else {
        Skipped::current_test("there is no chromium (PHOTINUS_CHROMIUM names another)");
        return;
    };
    let mut page = Page::open(&PageAddress { listen: "127.0.0.1:0".parse().unwrap(), token: None }).unwrap();
    let url = format!("http://{}/", page.address());
    let over = Arc::new(AtomicBool::new(false));
    let is_over = over.clone();
    let feeder = std::thread::spawn(move || {
        page.notice(&Notice { level: Level::Warning, up_s: 0.5, text: "left is <b>gone</b>".to_owned() })
            .unwrap();
        for index in 0.. {
            if is_over.load(Ordering::Relaxed) {
                break;
            }
            (0..2).for_each(|camera| page.frame(&entry(camera, index)).unwrap());
            std::thread::sleep(Duration::from_millis(16));
        }
    });
    browser.size(1400, 1000);
    browser.call("Page.navigate", json!({ "url": url }));
    browser.wait_for(
        "document.readyState == 'complete' && document.getElementById('found').innerText.includes('id 7')",
    );
    for part in ["left", "right", "5.10 to 8.40 m", "98 %", "live", "left is <b>gone</b>"] {
        browser.wait_for(&format!("document.body.innerText.includes({})", json!(part)));
    }
    // It goes on by itself, and the picture is the camera's.
    let frame = "+(document.querySelector('section h2 span').innerText.match(/frame (\\d+)/)?.[1] ?? 0)";
    browser.wait_for(&format!("{frame} > 0"));
    let before = browser.ask(frame).as_f64().unwrap();
    browser.wait_for(&format!("{frame} > {}", before + 30.0));
    let lit = "(() => { const canvas = document.querySelector('canvas'), pen = canvas.getContext('2d'); return pen.getImageData(0, 0, canvas.width, canvas.height).data.some((level, at) => at % 4 === 0 && level > 240); })()";
    browser.wait_for(lit);
    // Paused, it stands still; the slider shows what was before.
    browser.ask("document.getElementById('pause').click()");
    std::thread::sleep(Duration::from_millis(500));
    let stands = browser.ask(frame).as_f64().unwrap();
    std::thread::sleep(Duration::from_millis(600));
    assert!((browser.ask(frame).as_f64().unwrap() - stands).abs() < 0.5);
    browser.ask("{ const scrub = document.getElementById('scrub'); scrub.value = 0.2; scrub.oninput(); }");
    browser.wait_for(&format!("{frame} < {stands}"));
    browser.ask("document.getElementById('pause').click()");
    browser.wait_for(&format!("{frame} > {stands}"));
    assert!(browser.fits());
    browser.size(400, 800);
    std::thread::sleep(Duration::from_millis(500));
    assert!(browser.fits(), "nothing stands out of a phone's screen");
    over.store(true, Ordering::Relaxed);
    feeder.join().unwrap();
    browser.wait_for("document.getElementById('state').innerText == 'not connected'");
}
