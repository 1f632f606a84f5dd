//! A page in headless Chromium, spoken to over its debugging pipe: no driver, no port, no network.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Error, ErrorKind, Result, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The bytes that a text in base 64 stands for.
fn base64(text: &str) -> Vec<u8> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => Some(u32::from(c - b'A')),
        b'a'..=b'z' => Some(u32::from(c - b'a') + 26),
        b'0'..=b'9' => Some(u32::from(c - b'0') + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let digits: Vec<u32> = text.bytes().filter_map(digit).collect();
    let group = |four: &[u32]| {
        let sum = (0..4).fold(0, |sum, i| (sum << 6) | four.get(i).copied().unwrap_or(0));
        sum.to_be_bytes()[1..four.len()].to_vec()
    };
    digits.chunks(4).flat_map(group).collect()
}

/// A running Chromium with one page open.
pub struct Browser {
    process: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    session: Option<String>,
    sent: u64,
    events: Vec<Value>,
    _profile: tempfile::TempDir,
}

/// The name under which Chromium is installed, if it is; where it is not, the test that asks says that it was skipped.
pub fn chromium() -> Option<&'static str> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let works = |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success());
    let found = names.into_iter().find(works);
    if found.is_none() {
        crate::skipped::skipped("no Chromium on this machine; `cargo xtask test` installs it");
    }
    found
}

impl Browser {
    /// Starts Chromium and opens a blank page of `width` by `height` pixels.
    pub fn start(program: &str, width: u32, height: u32) -> Result<Self> {
        let profile = tempfile::tempdir()?;
        let flags = "--headless --hide-scrollbars --no-sandbox --disable-gpu --disable-dev-shm-usage --no-first-run \
                     --disable-background-networking --disable-component-update --remote-debugging-pipe";
        // Chromium speaks on descriptors 3 and 4; the shell ties them to this process' two pipes.
        let line = format!("exec {program} {flags} --user-data-dir=\"$0\" about:blank 3<&0 4>&1 1>/dev/null 2>&1");
        let mut process = Command::new("sh")
            .args(["-c", &line])
            .arg(profile.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let missing = || Error::other("the browser's pipes are missing");
        let to = process.stdin.take().ok_or_else(missing)?;
        let from = BufReader::new(process.stdout.take().ok_or_else(missing)?);
        let mut browser = Self { process, to, from, session: None, sent: 0, events: Vec::new(), _profile: profile };
        let target = browser.call("Target.createTarget", &json!({"url": "about:blank"}))?;
        let attached =
            browser.call("Target.attachToTarget", &json!({"targetId": target["targetId"], "flatten": true}))?;
        browser.session = attached["sessionId"].as_str().map(String::from);
        for domain in ["Page", "Runtime", "Network", "Log"] {
            browser.call(&format!("{domain}.enable"), &json!({}))?;
        }
        browser.resize(width, height)?;
        Ok(browser)
    }

    /// Makes the window `width` by `height` pixels.
    pub fn resize(&mut self, width: u32, height: u32) -> Result<()> {
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", &size)?;
        self.settle()
    }

    /// Opens a file and waits until it is loaded and has drawn.
    pub fn open(&mut self, path: &Path) -> Result<()> {
        self.visit(&format!("file://{}", path.display()))
    }

    /// Opens an address and waits until it is loaded and has drawn.
    pub fn visit(&mut self, address: &str) -> Result<()> {
        self.events.retain(|e| e["method"] != "Page.loadEventFired");
        self.call("Page.navigate", &json!({"url": address}))?;
        while !self.events.iter().any(|e| e["method"] == "Page.loadEventFired") {
            let event = self.receive()?;
            self.events.push(event);
        }
        self.settle()
    }

    /// Waits for two frames, so that what was asked for is on the screen.
    pub fn settle(&mut self) -> Result<()> {
        self.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))")
            .map(drop)
    }

    /// What a script in the page comes to; a promise is waited for.
    pub fn value(&mut self, script: &str) -> Result<Value> {
        let asked = json!({"expression": script, "awaitPromise": true, "returnByValue": true});
        let answer = self.call("Runtime.evaluate", &asked)?;
        if answer["exceptionDetails"].is_null() {
            return Ok(answer["result"]["value"].clone());
        }
        Err(Error::other(format!("{script}: {}", answer["exceptionDetails"])))
    }

    /// Presses, moves or releases the mouse: `kind` is `mousePressed`, `mouseMoved` or `mouseReleased`.
    pub fn mouse(&mut self, kind: &str, x: f64, y: f64, clicks: u32) -> Result<()> {
        let pressed = u32::from(kind != "mouseReleased");
        let event = json!({"type": kind, "x": x, "y": y, "button": "left", "buttons": pressed, "clickCount": clicks});
        self.call("Input.dispatchMouseEvent", &event).map(drop)
    }

    /// Puts files into the field of the page that `selector` finds, as a reader drops them there.
    pub fn choose(&mut self, selector: &str, files: &[&Path]) -> Result<()> {
        let document = self.call("DOM.getDocument", &json!({}))?;
        let asked = json!({"nodeId": document["root"]["nodeId"], "selector": selector});
        let field = self.call("DOM.querySelector", &asked)?;
        let files: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
        self.call("DOM.setFileInputFiles", &json!({"nodeId": field["nodeId"], "files": files})).map(drop)
    }

    /// Whether closing the page asks the reader first; it is not closed then.
    pub fn asks_before_closing(&mut self) -> Result<bool> {
        self.events.retain(|e| e["method"] != "Page.javascriptDialogOpening");
        self.call("Page.close", &json!({}))?;
        loop {
            if let Some(asked) = self.events.iter().position(|e| e["method"] == "Page.javascriptDialogOpening") {
                self.events.remove(asked);
                self.call("Page.handleJavaScriptDialog", &json!({"accept": false}))?;
                return Ok(true);
            }
            let event = self.receive()?;
            if event["method"] == "Target.detachedFromTarget" {
                return Ok(false);
            }
            self.events.push(event);
        }
    }

    /// Presses and releases a key by its name, such as `a`, `Enter` or `Escape`.
    pub fn key(&mut self, key: &str) -> Result<()> {
        let text = match key {
            "Enter" => "\r",
            one if one.len() == 1 => one,
            _ => "",
        };
        let code = match key {
            "Enter" => 13,
            "Escape" => 27,
            _ => i32::from(key.to_uppercase().as_bytes()[0]),
        };
        for kind in ["keyDown", "keyUp"] {
            let event = json!({"type": kind, "key": key, "text": if kind == "keyDown" { text } else { "" },
                "windowsVirtualKeyCode": code, "nativeVirtualKeyCode": code});
            self.call("Input.dispatchKeyEvent", &event)?;
        }
        Ok(())
    }

    /// Bytes of the page's scripts after a collection of garbage.
    pub fn heap(&mut self) -> Result<f64> {
        self.call("HeapProfiler.collectGarbage", &json!({}))?;
        let usage = self.call("Runtime.getHeapUsage", &json!({}))?;
        Ok(usage["usedSize"].as_f64().unwrap_or(f64::NAN))
    }

    /// Forgets what was recorded of requests and complaints.
    pub fn forget(&mut self) {
        self.events.clear();
    }

    /// Shows the page as a reader with this colour scheme sees it: `light` or `dark`.
    pub fn scheme(&mut self, scheme: &str) -> Result<()> {
        let feature = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        self.call("Emulation.setEmulatedMedia", &feature)?;
        self.settle()
    }

    /// Writes a picture of the whole page.
    pub fn picture(&mut self, path: &Path) -> Result<()> {
        let asked = json!({"format": "png", "captureBeyondViewport": true});
        let answer = self.call("Page.captureScreenshot", &asked)?;
        std::fs::write(path, base64(answer["data"].as_str().unwrap_or_default()))
    }

    /// Every address the page asked for, itself first.
    pub fn requests(&self) -> Vec<String> {
        let asked = self.events.iter().filter(|e| e["method"] == "Network.requestWillBeSent");
        asked.filter_map(|e| e["params"]["request"]["url"].as_str().map(String::from)).collect()
    }

    /// Every exception, console message and browser complaint.
    pub fn complaints(&self) -> Vec<String> {
        let bad = ["Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Log.entryAdded"];
        let complaints = self.events.iter().filter(|e| e["method"].as_str().is_some_and(|m| bad.contains(&m)));
        complaints.map(|e| e["params"].to_string()).collect()
    }

    fn call(&mut self, method: &str, parameters: &Value) -> Result<Value> {
        self.sent += 1;
        let mut message = json!({"id": self.sent, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            message["sessionId"] = session.clone().into();
        }
        self.to.write_all(format!("{message}\0").as_bytes())?;
        self.to.flush()?;
        loop {
            let mut answer = self.receive()?;
            if answer["id"] != self.sent {
                self.events.push(answer);
            } else if answer["error"].is_null() {
                return Ok(answer["result"].take());
            } else {
                return Err(Error::other(format!("{method}: {}", answer["error"])));
            }
        }
    }

    fn receive(&mut self) -> Result<Value> {
        let mut bytes = Vec::new();
        self.from.read_until(0, &mut bytes)?;
        if bytes.pop() != Some(0) {
            return Err(Error::new(ErrorKind::UnexpectedEof, "the browser went away"));
        }
        Ok(serde_json::from_slice(&bytes)?)
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        self.session = None;
        let _ = self.call("Browser.close", &json!({}));
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
