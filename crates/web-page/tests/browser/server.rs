//! A server on this machine that has one file, whatever is requested.

use std::io::{BufRead, BufReader, Write};
use std::net::{SocketAddr, TcpListener};
use std::sync::{Arc, Mutex};

/// The server's address, and what was requested.
pub struct Requests {
    pub address: SocketAddr,
    paths: Arc<Mutex<Vec<String>>>,
}

impl Requests {
    /// The requested paths so far.
    pub fn paths(&self) -> Vec<String> {
        self.paths.lock().unwrap().clone()
    }
}

/// Serves a page until the test ends.
pub fn serve(page: Vec<u8>) -> Requests {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let requests = Requests { address: listener.local_addr().unwrap(), paths: Arc::default() };
    let paths = requests.paths.clone();
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            let mut lines = BufReader::new(&stream).lines().map_while(Result::ok);
            let Some(request) = lines.next() else { continue };
            lines.take_while(|line| !line.is_empty()).for_each(drop);
            paths.lock().unwrap().push(request.split(' ').nth(1).unwrap_or_default().to_owned());
            let head = format!(
                "HTTP/1.1 200 OK\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
                page.len()
            );
            let _ = stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(&page));
        }
    });
    requests
}
