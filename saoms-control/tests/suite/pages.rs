//! The dashboard's pages: who gets them, what a form and a cookie are good for, and what each right allows.

use std::fs;

use saoms_control::{Client, Token, openapi};
use serde_json::Value;

use super::network::exchange;
use super::{Served, served};

/// The status of an answer, its headers in small letters, and its body.
struct Answer {
    status: u16,
    head: String,
    body: String,
}

impl Served {
    fn token(&self, is_control: bool) -> String {
        let file = if is_control { &self.token } else { &self.view_token };
        fs::read_to_string(file).unwrap().trim().to_owned()
    }

    /// Sends a request with these headers and this body, as a page of the server would.
    fn send(&self, method: &str, path: &str, headers: &[&str], body: &str) -> Answer {
        let own = format!("Host: {}", self.address);
        let length = format!("Content-Length: {}", body.len());
        let headers = [&[&*own, &*length], headers].concat().join("\r\n");
        let text = exchange(&self.address, &format!("{method} {path} HTTP/1.0\r\n{headers}\r\n\r\n{body}"));
        let (head, body) = text.split_once("\r\n\r\n").unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        Answer { status, head: head.to_lowercase(), body: body.to_owned() }
    }

    /// Logs in with a token: the cookie.
    fn log_in(&self, token: &str) -> Option<String> {
        let answer =
            self.send("POST", "/login", &[&format!("Origin: http://{}", self.address)], &format!("token={token}"));
        let cookie = answer.head.lines().find_map(|line| line.strip_prefix("set-cookie: ").map(str::to_owned));
        assert_eq!(answer.status, if cookie.is_some() { 303 } else { 401 });
        cookie
    }
}

/// The name and value of a cookie, as a browser sends it.
fn sent(cookie: &str) -> String {
    format!("Cookie: {}", cookie.split(';').next().unwrap())
}

#[test]
fn who_has_no_session_gets_the_form() {
    let served = served();
    let page = served.send("GET", "/", &[], "");
    assert_eq!((page.status, page.head.contains("location: /login")), (303, true), "{}", page.head);
    let form = served.send("GET", "/login", &[], "");
    assert_eq!(form.status, 200);
    assert!(form.body.contains("<form method=\"post\" action=\"/login\">") && !form.body.contains("not a token"));
    let wrong = served.send("POST", "/login", &[], "token=0123456789abcdef");
    assert_eq!(wrong.status, 401);
    assert!(wrong.body.contains("not a token of this fleet") && !wrong.head.contains("set-cookie"), "{}", wrong.head);
    assert_eq!(served.send("GET", "/v1/status", &["Cookie: saoms=1"], "").status, 401);
}

#[test]
fn a_cookie_stands_for_the_token_and_is_not_it() {
    let served = served();
    let port = served.address.rsplit(':').next().unwrap().to_owned();
    for is_control in [true, false] {
        let token = served.token(is_control);
        let cookie = served.log_in(&token).unwrap();
        for part in [&*format!("saoms-{port}="), "; httponly", "; samesite=strict", "; path=/"] {
            assert!(cookie.contains(part), "{part}: {cookie}");
        }
        assert!(!cookie.contains(&token) && !cookie.contains("domain"), "{cookie}");
        let session = served.send("GET", "/v1/session", &[&sent(&cookie)], "");
        let session: Value = serde_json::from_str(&session.body).unwrap();
        assert_eq!(session["right"], if is_control { "control" } else { "view" });
        assert_eq!(served.send("GET", "/", &[&sent(&cookie)], "").status, 200);
        let event = served.send("POST", "/v1/events", &[&sent(&cookie)], "right");
        assert_eq!(event.status, if is_control { 200 } else { 403 }, "{}", event.body);
        // A page of another server of this machine has the cookie sent along.
        let foreign = ["Origin: http://127.0.0.1:1", &sent(&cookie)];
        assert_eq!(served.send("POST", "/v1/events", &foreign, "right").status, 403);
        let out = served.send("POST", "/logout", &[&sent(&cookie)], "");
        assert!(out.status == 303 && out.head.contains("max-age=0"), "{}", out.head);
        assert_eq!(served.send("GET", "/v1/status", &[&sent(&cookie)], "").status, 401);
    }
    assert_eq!(served.log_in("0123456789abcdef"), None);
    assert_eq!(served.send("POST", "/login", &["Origin: http://evil.example"], "token=1").status, 403);
}

#[test]
fn who_may_view_sees_everything_and_orders_nothing() {
    let served = served();
    let client = Client::of_network(&served.of_network.place(), Token::read(&served.view_token).unwrap()).unwrap();
    assert_eq!(client.description().unwrap().pid, 7);
    let mut orders = 0;
    for (path, operations) in openapi()["paths"].as_object().unwrap() {
        for method in operations.as_object().unwrap().keys() {
            let path = path.replace(['{', '}'], "");
            let refused =
                client.request(&method.to_uppercase(), &path, "1").map(drop).map_err(|error| error.to_string());
            let is_refused = refused.is_err_and(|error| error.contains("the right to view"));
            assert_eq!(is_refused, method != "get", "{method} {path}");
            orders += usize::from(is_refused);
        }
    }
    assert!(orders > 10, "{orders}");
    assert_eq!(served.downs.load(std::sync::atomic::Ordering::SeqCst), 0);
}

#[test]
fn pages_load_nothing_but_files_of_the_server() {
    let served = served();
    let cookie = sent(&served.log_in(&served.token(false)).unwrap());
    let page = served.send("GET", "/", &[&cookie], "");
    let mut files: Vec<String> =
        page.body.split('"').filter(|part| part.starts_with("/assets/")).map(str::to_owned).collect();
    assert!(files.len() >= 3, "{}", page.body);
    // The modules that these load.
    let mut seen = 0;
    while seen < files.len() {
        let file = served.send("GET", &files[seen], &[], "");
        assert_eq!(file.status, 200, "{}", files[seen]);
        assert!(file.head.contains("x-content-type-options: nosniff"), "{}", file.head);
        let kind = file.head.lines().find_map(|line| line.strip_prefix("content-type: ")).unwrap();
        let ending = files[seen].rsplit('.').next().unwrap();
        assert!(kind.contains(if ending == "js" { "javascript" } else { ending }), "{}: {kind}", files[seen]);
        let imports =
            file.body.lines().filter(|line| line.starts_with("import ")).filter_map(|line| line.split('"').nth(1));
        let folder = files[seen].rsplit_once('/').unwrap().0;
        let imports: Vec<String> = imports.map(|name| name.replacen('.', folder, 1)).collect();
        files.extend(imports.into_iter().filter(|name| !files.contains(name)).collect::<Vec<_>>());
        seen += 1;
    }
    assert!(seen > 8, "{files:?}");
    for answer in [page, served.send("GET", "/login", &[], ""), served.send("GET", "/v1/fleet", &[&cookie], "")] {
        let policy = answer.head.lines().find_map(|line| line.strip_prefix("content-security-policy: ")).unwrap();
        assert!(policy.starts_with("default-src 'self';") && policy.contains("frame-ancestors 'none'"), "{policy}");
        assert!(!policy.contains("unsafe") && !answer.body.contains("<script>") && !answer.body.contains("style="));
    }
    for missing in
        ["/assets/none.js", "/assets/..%2fCargo.toml", "/assets/views/floor/none.js", "/assets/views/none/view.js"]
    {
        assert_eq!(served.send("GET", missing, &[], "").status, 404, "{missing}");
    }
}

#[test]
fn the_socket_serves_the_page_and_refuses_pages_of_other_sites() {
    let served = served();
    assert!(served.client.request("GET", "/", "").unwrap().text().unwrap().contains("/assets/app.js"));
    let session = served.client.request("GET", "/v1/session", "").unwrap().json().unwrap();
    assert_eq!(session["right"], "control");
    let send = |headers: &str| {
        use std::io::{Read, Write};
        let mut stream = std::os::unix::net::UnixStream::connect(&served.socket).unwrap();
        write!(stream, "POST /v1/events HTTP/1.0\r\n{headers}Content-Length: 5\r\n\r\nright").unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer.split(' ').nth(1).unwrap().to_owned()
    };
    assert_eq!(send("Host: localhost\r\n"), "200");
    assert_eq!(send("Host: anything\r\n"), "200");
    assert_eq!(send("Host: localhost:8080\r\nOrigin: http://localhost:8080\r\n"), "200");
    assert_eq!(send("Host: localhost:8080\r\nOrigin: http://evil.example\r\n"), "403");
    assert_eq!(send("Host: evil.example\r\nOrigin: http://evil.example\r\n"), "403");
}

#[test]
fn the_stream_tells_the_fleet_the_alerts_and_what_there_is_not() {
    let served = served();
    let response = served.client.request("GET", "/v1/stream?topics=NOTHING&component=Nobody", "").unwrap();
    let mut names = Vec::new();
    for (name, data) in response.events().take(4) {
        let data: Value = serde_json::from_str(&data).unwrap();
        match &*name {
            "status" if data["all"] == true => assert_eq!(data["fleet"]["pid"], 7),
            "alerts" => assert_eq!(data, serde_json::json!([])),
            "records" => assert!(data["error"].as_str().unwrap().contains("no component `Nobody`"), "{data}"),
            _ => {}
        }
        names.push(name);
    }
    for name in ["status", "alerts", "records"] {
        assert!(names.iter().any(|one| one == name), "{name}: {names:?}");
    }
}
