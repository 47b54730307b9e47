//! Services of a fleet that programs of the web call.

use std::fs;
use std::io::Write;
use std::net::TcpStream;
use std::thread::sleep;
use std::time::Duration;

use serde_json::{Value, json};

use super::{BOLT, Server, local, store};

#[test]
fn a_service_is_called_with_json_and_answers_in_json() {
    for virtual_time in [&[][..], &["--virtual", "--speed", "1"]] {
        let arguments = [virtual_time, &["--journal", "journal.json"]].concat();
        let mut server = Server::start(&(store("<binding.rest uri=\"/stock\"/>", "") + &local()), &arguments);
        assert_eq!(server.call("/stock/putPart", BOLT), (200, json!(3)));
        assert_eq!(server.call("/stock/putPart", BOLT), (200, json!(6)));
        let parts = json!([{"name": "bolt", "count": 6, "sizes": [1.5, 2.0], "note": null}]);
        assert_eq!(server.call("/stock/parts", r#"{"least": 6}"#), (200, parts));
        assert_eq!(server.call("/stock/%70arts", r#"{"least": 7}"#), (200, json!([])));
        // Without arguments the body may be left out, and without a reply there is none.
        assert_eq!(server.call("/stock/clear", ""), (204, Value::Null));
        assert_eq!(server.call("/stock/parts", r#"{"least": 0}"#), (200, json!([])));
        server.running.told(&["down"]);
        let (code, printed) = server.running.wait();
        assert_eq!(code, Some(0), "{printed}");
        // It is in the journal as an order.
        let journal = fs::read_to_string(server.running.folder().join("journal.json")).unwrap();
        assert!(journal.contains("call Store/stock.parts least=0"), "{journal}");
        let said = format!("offers services over the web at http://{}: `/stock`", server.address);
        assert!(printed.contains(&said), "{printed}");
    }
}

#[test]
fn all_that_is_wrong_with_a_call_is_told_at_once() {
    let server = Server::start(&store("<binding.rest uri=\"/stock\"/>", ""), &[]);
    let wrong = r#"{"part": {"nmae": "bolt", "count": -1, "sizes": [1, "two"], "more": 1}, "also": 2}"#;
    let problem = server.problem("/stock/putPart", wrong, 400);
    assert_eq!(problem["title"], "Bad Request");
    let told: Vec<(&str, &str)> = problem["errors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| (one["pointer"].as_str().unwrap(), one["detail"].as_str().unwrap()))
        .collect();
    let expected = [
        ("/also", "`putPart` has no field `also`; its fields are: part"),
        ("/part/more", "`Part` has no field `more`; its fields are: name, count, sizes, note"),
        ("/part/nmae", "`Part` has no field `nmae`; did you mean `name`?"),
        ("/part/count", "found -1, expected a whole number from 0 to 4294967295"),
        ("/part/sizes/1", "found \"two\", expected a number"),
    ];
    assert_eq!(told, expected);
    let detail = problem["detail"].as_str().unwrap();
    assert!(detail.contains("operation `putPart(part: Part) -> uint32`"), "{detail}");
    assert!(detail.contains("field `part.sizes[1]`: found \"two\""), "{detail}");
    for (body, expected) in [
        ("[1]", "found [1], expected an object"),
        ("{\"least\": \"6\"}", "field `least`: found \"6\", expected a whole number"),
        ("{\"least\": 6", "the body is not JSON: EOF while parsing an object at line 1 column 11"),
        ("", "field `least` of `parts` is missing"),
    ] {
        let problem = server.problem("/stock/parts", body, 400);
        assert!(problem["detail"].as_str().unwrap().contains(expected), "{problem}");
    }
    for (path, expected) in [
        ("/stock/part", "the service at `/stock` has no operation `part`; did you mean `parts`?"),
        ("/stock", "`/stock` names no operation; the service has the operations `putPart`, `parts`, `clear`, `rest`"),
        ("/stock/parts/1", "the service at `/stock` has no operation `parts/1`; did you mean `parts`?"),
        ("/stok/parts", "there is no service at `/stok/parts`; did you mean `/stock`?"),
        ("/far/away", "there is no service at `/far/away`; `GET /v1/openapi.json` describes all services"),
    ] {
        assert_eq!(server.problem(path, "{}", 404)["detail"], expected);
    }
    // Paths of the server itself are as before.
    let (status, _, body) = server.request("POST", "/v1/stock/parts", &server.token, "", "");
    assert_eq!((status, body.contains("there is no such route")), (404, true), "{body}");
    let failed = server.problem("/stock/putPart", &BOLT.replace("bolt", ""), 500);
    assert!(failed["detail"].as_str().unwrap().contains("a part has a name"), "{failed}");
    let long = format!("{{\"least\": {}}}", "1".repeat(70_000));
    assert_eq!(server.problem("/stock/parts", &long, 413)["title"], "Payload Too Large");
    let refused = |method: &str, token: &str, headers: &str| {
        let (status, head, body) = server.request(method, "/stock/parts", token, headers, "{\"least\": 1}");
        let problem: Value = serde_json::from_str(&body).unwrap();
        assert_eq!(problem["status"], status, "{body}");
        (status, head, problem["detail"].as_str().unwrap().to_owned())
    };
    let (status, head, detail) = refused("GET", &server.token, "");
    assert_eq!((status, head.contains("allow: post")), (405, true));
    assert!(detail.contains("`parts(least: uint32) -> sequence of Part`"), "{detail}");
    let (status, _, detail) = refused("POST", &server.token, "Content-Type: text/plain\r\n");
    assert_eq!((status, detail.contains("found the type `text/plain`, expected JSON")), (415, true), "{detail}");
    // Who may view calls nothing: a call may change something.
    let (status, _, detail) = refused("POST", &server.view_token, "");
    assert_eq!((status, detail.contains("right to view")), (403, true), "{detail}");
    let (status, head, _) = refused("POST", "", "");
    assert_eq!((status, head.contains("www-authenticate: bearer")), (401, true));
    let (status, ..) = refused("POST", &server.token, "Origin: http://evil.example\r\n");
    assert_eq!(status, 403);
}

#[test]
fn a_component_that_takes_long_holds_nobody_else_up() {
    let attributes = " s:deadline=\"400ms\"";
    let two = store("<binding.rest uri=\"/stock\"/>", attributes)
        + &store("<binding.rest uri=\"/other\"/>", attributes).replace("name=\"Store\"", "name=\"Other\"");
    let server = Server::start(&two, &[]);
    let late = server.problem("/stock/rest", "{\"time\": 1500}", 504);
    let detail = late["detail"].as_str().unwrap();
    assert!(detail.contains("no answer came within 400ms: the call has begun"), "{detail}");
    // It is still at it, and others are served.
    assert_eq!(server.call("/other/parts", "{\"least\": 1}"), (200, json!([])));
    let withdrawn = server.problem("/stock/putPart", BOLT, 504);
    assert!(withdrawn["detail"].as_str().unwrap().contains("it is withdrawn"), "{withdrawn}");
    // What was withdrawn has no effect.
    let parts = (0..200).find_map(|_| {
        sleep(Duration::from_millis(20));
        let (status, parts) = server.call("/stock/parts", "{\"least\": 0}");
        (status == 200).then_some(parts)
    });
    assert_eq!(parts, Some(json!([])));
    server.running.told(&["pause"]);
    assert_eq!(server.call("/stock/clear", "").0, 204, "a passive component is called in a pause, too");
}

#[test]
fn the_call_of_a_client_that_hangs_up_is_withdrawn() {
    let server = Server::start(&(store("<binding.rest uri=\"/stock\"/>", " s:deadline=\"1min\"") + &local()), &[]);
    // Operators wait for less time than this takes.
    let (status, _, body) =
        server.request("POST", "/v1/components/Store/operations/rest", &server.token, "", "{\"time\": 2500}");
    assert!(status == 422 && body.contains("the order has begun"), "{status} {body}");
    let mut stream = TcpStream::connect(&server.address).unwrap();
    let (token, length) = (&server.token, BOLT.len());
    let head =
        format!("POST /stock/putPart HTTP/1.1\r\nHost: a\r\nAuthorization: Bearer {token}\r\nContent-Length: {length}");
    stream.write_all(format!("{head}\r\n\r\n{BOLT}").as_bytes()).unwrap();
    // It is on its way to the component, unless the server is slow.
    sleep(Duration::from_millis(300));
    drop(stream);
    assert_eq!(server.call("/stock/parts", "{\"least\": 0}"), (200, json!([])));
}

#[test]
fn a_component_that_panics_in_a_call_is_a_failure_of_the_server() {
    let server = Server::start(&(store("<binding.rest uri=\"/stock\"/>", "") + &local()), &[]);
    let failed = server.problem("/stock/putPart", &BOLT.replace('3', "1000000"), 500);
    assert!(failed["detail"].as_str().unwrap().contains("nobody counts so far"), "{failed}");
    let gone = server.problem("/stock/clear", "", 503);
    assert_eq!(gone["detail"], "component `Store` does not run");
    server.running.told(&["down"]);
    let (code, printed) = server.running.end();
    assert!(code == Some(1) && printed.contains("nobody counts so far"), "{printed}");
}

#[test]
fn the_services_of_a_fleet_are_in_its_document() {
    let server = Server::start(&store("<s:binding.rest/>", ""), &[]);
    let (status, _, body) = server.request("GET", "/v1/openapi.json", &server.view_token, "", "");
    assert_eq!(status, 200);
    let document: Value = serde_json::from_str(&body).unwrap();
    let put = &document["paths"]["/services/Store/stock/putPart"]["post"];
    assert_eq!(put["summary"], "putPart(part: Part) -> uint32");
    let schema = &put["requestBody"]["content"]["application/json"]["schema"];
    assert_eq!(schema["properties"]["part"]["properties"]["count"]["maximum"], u32::MAX);
    assert_eq!(schema["properties"]["part"]["required"], json!(["name", "count", "sizes"]));
    assert_eq!(put["responses"]["200"]["content"]["application/json"]["schema"]["type"], "integer");
    assert_eq!(put["requestBody"]["required"], true);
    let clear = &document["paths"]["/services/Store/stock/clear"]["post"];
    assert_eq!(clear["requestBody"]["required"], false);
    assert!(clear["responses"]["204"].is_object() && clear["responses"]["200"].is_null(), "{clear}");
    assert!(document["paths"]["/v1/status"].is_object());
    let problem = &put["responses"]["400"]["content"]["application/problem+json"]["schema"]["$ref"];
    assert!(document.pointer(problem.as_str().unwrap().strip_prefix('#').unwrap()).is_some());
    assert_eq!(server.call("/services/Store/stock/clear", "{}"), (204, Value::Null));
}
