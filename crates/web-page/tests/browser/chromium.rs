//! Chromium without a window, driven through DevTools' protocol over two named pipes.

use serde_json::{Value, json};
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// How long anything may take on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser with one page.
pub struct Chromium {
    process: Child,
    commands: File,
    replies: BufReader<File>,
    calls: u64,
    session: String,
    /// What the browser reported since the page was opened.
    pub events: Vec<Value>,
    _profile: tempfile::TempDir,
}

impl Chromium {
    /// Starts the browser. `None`, with a message on stderr, where it is not installed.
    pub fn start() -> Option<Self> {
        let is_installed =
            |name: &&&str| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success());
        let Some(program) = ["chromium", "chromium-browser", "google-chrome"].iter().find(is_installed)
        else {
            eprintln!("SKIPPED: no Chromium, so no page was opened (apt-get install chromium)");
            return None;
        };
        let profile = tempfile::tempdir().unwrap();
        let [commands, replies] = ["commands", "replies"].map(|name| profile.path().join(name));
        assert!(Command::new("mkfifo").args([&commands, &replies]).status().unwrap().success());
        let flags = [
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
            "--remote-debugging-pipe",
            // A sandboxed frame stays in the page's process, where it can be examined.
            "--disable-features=IsolateSandboxedIframes",
            "--disable-site-isolation-trials",
            "--window-size=1280,800",
        ];
        let process = Command::new("sh")
            .args(["-c", r#"exec "$@" 3<"$COMMANDS" 4>"$REPLIES""#, "sh", program])
            .args(flags)
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .envs([("COMMANDS", &commands), ("REPLIES", &replies)])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let commands = File::options().write(true).open(commands).unwrap();
        let replies = BufReader::new(File::open(replies).unwrap());
        let (calls, session, events) = (0, String::new(), Vec::new());
        let mut browser = Self { process, commands, replies, calls, session, events, _profile: profile };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let attach = json!({"targetId": target["targetId"], "flatten": true});
        let attached = browser.call("Target.attachToTarget", attach);
        browser.session = attached["sessionId"].as_str().unwrap().into();
        for domain in ["Page", "Runtime", "Network", "Log"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        Some(browser)
    }

    /// Calls a method of the protocol, and returns its result.
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.calls += 1;
        let mut command = json!({"id": self.calls, "method": method, "params": parameters});
        if !self.session.is_empty() {
            command["sessionId"] = json!(self.session);
        }
        self.commands.write_all(format!("{command}\0").as_bytes()).unwrap();
        loop {
            let mut reply = Vec::new();
            self.replies.read_until(0, &mut reply).unwrap();
            assert_eq!(reply.pop(), Some(0), "{method}: the browser has ended");
            let reply: Value = serde_json::from_slice(&reply).unwrap();
            if reply["id"] == self.calls {
                assert!(reply["error"].is_null(), "{method} {parameters}: {}", reply["error"]);
                return reply["result"].clone();
            }
            self.events.push(reply);
        }
    }

    /// Opens a page, and waits until it is loaded.
    pub fn open(&mut self, address: &str) {
        self.events.clear();
        self.call("Page.navigate", json!({"url": address}));
        self.wait_for("document.readyState === 'complete' && location.href !== 'about:blank'");
    }

    /// The value of an expression in the page, or, once it is resolved, of its promise.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        self.evaluate_in(None, expression)
    }

    /// The same in a frame, by its execution context.
    pub fn evaluate_in(&mut self, context: Option<i64>, expression: &str) -> Value {
        let mut parameters = json!({"expression": expression, "awaitPromise": true, "returnByValue": true});
        if let Some(context) = context {
            parameters["contextId"] = json!(context);
        }
        let result = self.call("Runtime.evaluate", parameters);
        assert!(result["exceptionDetails"].is_null(), "{expression}: {}", result["exceptionDetails"]);
        result["result"]["value"].clone()
    }

    /// Waits until an expression in the page is true.
    pub fn wait_for(&mut self, expression: &str) {
        self.wait_for_in(None, expression);
    }

    /// The same in a frame.
    pub fn wait_for_in(&mut self, context: Option<i64>, expression: &str) {
        let start = Instant::now();
        while self.evaluate_in(context, expression) != true {
            assert!(start.elapsed() < PATIENCE, "never true: {expression}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// The execution contexts of the page and its frames that were made since it was opened, outermost first.
    pub fn contexts(&self) -> Vec<i64> {
        let created = self.events.iter().filter(|event| event["method"] == "Runtime.executionContextCreated");
        created.filter_map(|event| event["params"]["context"]["id"].as_i64()).collect()
    }

    /// What went wrong in the page, and what it requested, apart from itself and data in it.
    pub fn complaints(&self, own_addresses: &[&str]) -> Vec<String> {
        let complaint = |event: &Value| {
            let parameters = &event["params"];
            match event["method"].as_str()? {
                "Runtime.exceptionThrown" | "Runtime.consoleAPICalled" => Some(parameters.to_string()),
                "Log.entryAdded" => (parameters["entry"]["level"] == "error").then(|| parameters.to_string()),
                "Network.requestWillBeSent" => {
                    let address = parameters["request"]["url"].as_str()?;
                    let is_own = address.starts_with("data:") || own_addresses.contains(&address);
                    (!is_own).then(|| format!("requested {address}"))
                }
                _ => None,
            }
        };
        self.events.iter().filter_map(complaint).collect()
    }

    /// Moves the mouse, or presses, releases or turns what is on it.
    pub fn mouse(&mut self, kind: &str, [x, y]: [f64; 2], more: Value) {
        let mut parameters = json!({"type": kind, "x": x, "y": y});
        parameters.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        self.call("Input.dispatchMouseEvent", parameters);
    }

    /// Clicks with the left button.
    pub fn click(&mut self, at: [f64; 2]) {
        let button = json!({"button": "left", "buttons": 1, "clickCount": 1});
        self.mouse("mousePressed", at, button.clone());
        self.mouse("mouseReleased", at, button);
    }

    /// Puts fingers on the screen, moves them, or, without any, lifts them.
    pub fn touch(&mut self, kind: &str, fingers: &[[f64; 2]]) {
        let points: Vec<_> =
            fingers.iter().enumerate().map(|(id, [x, y])| json!({"x": x, "y": y, "id": id})).collect();
        self.call("Input.dispatchTouchEvent", json!({"type": kind, "touchPoints": points}));
    }

    /// Presses and releases a key, named as in its event.
    pub fn key(&mut self, key: &str) {
        let mut parameters = json!({"type": "keyDown", "key": key});
        if key.chars().count() == 1 {
            parameters["text"] = json!(key);
        }
        self.call("Input.dispatchKeyEvent", parameters);
        self.call("Input.dispatchKeyEvent", json!({"type": "keyUp", "key": key}));
    }

    /// Sets the window's size, px.
    pub fn resize(&mut self, [width, height]: [u32; 2]) {
        let is_mobile = width < 600;
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": is_mobile});
        self.call("Emulation.setDeviceMetricsOverride", metrics);
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
