//! Random keystrokes in real composites: what is shown in the end is what `saoms check` finds in the text.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::editor::Editor;

/// A source of chance: xorshift64* (Vigna, 2016).
struct Chance(u64);

impl Chance {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % end.max(1)
    }

    fn pick<'p>(&mut self, all: &[&'p str]) -> &'p str {
        all[self.below(all.len())]
    }
}

/// A change: the bytes that go, and what comes in their place.
struct Keystroke {
    start: usize,
    end: usize,
    new: String,
}

/// Something that a person types: mostly in the middle of words, sometimes what breaks the text, which is mended at
/// once.
fn typed(text: &str, chance: &mut Chance) -> Vec<Keystroke> {
    const BREAKING: [&str; 12] = ["<", ">", "\"", "&", "</", "\r\n", "🤖", "<!--", "${", "/>", "ä", "<component "];
    let start = text.floor_char_boundary(chance.below(text.len()));
    if chance.below(5) == 0 {
        let new = chance.pick(&BREAKING).to_owned();
        let behind = start + new.len();
        return vec![Keystroke { start, end: start, new }, Keystroke { start, end: behind, new: String::new() }];
    }
    // A letter or a digit of a value gets another one, two, or none.
    let is_word = |at: &usize| text.as_bytes()[*at].is_ascii_alphanumeric();
    let inside = |at: &usize| {
        let line = &text[text[..*at].rfind('\n').map_or(0, |found| found + 1)..*at];
        line.matches('"').count() % 2 == 1 || line.contains('>') && !line.trim_end().ends_with('<')
    };
    let is_xml = text.starts_with('<');
    let is_value = |at: &usize| is_word(at) && (!is_xml || inside(at)) && !text[..*at].ends_with('/');
    let Some(at) = (start..text.len()).find(is_value) else { return Vec::new() };
    let new = chance.pick(&["x", "7", "", "R", "0", "🤖", "ab", "ü"]).to_owned();
    vec![Keystroke { start: at, end: at + 1, new }]
}

/// A byte as the protocol names it.
fn place(text: &str, at: usize) -> Value {
    let start = text[..at].rfind('\n').map_or(0, |found| found + 1);
    json!({ "line": text[..at].matches('\n').count(), "character": text[start..at].encode_utf16().count() })
}

/// The diagnostics: code, severity, both ends, and message.
type Found = Vec<(String, String, [usize; 4], String)>;

/// The diagnostics of `saoms check` for a file of a folder.
fn checked(folder: &Path, file: &str) -> Found {
    let output = crate::support::saoms_in(folder, &["check", "--format", "json", "."]);
    let all: Value = serde_json::from_slice(&output.stdout).unwrap();
    let all = all["diagnostics"].as_array().unwrap().iter();
    let mut found: Found = all
        .filter(|one| Path::new(one["file"].as_str().unwrap()).ends_with(file))
        .map(|one| {
            let at = ["line", "column", "end_line", "end_column"];
            let text = |key: &str| one[key].as_str().unwrap_or_default().to_owned();
            let help = text("help");
            let said = if help.is_empty() { text("message") } else { format!("{}\n{help}", text("message")) };
            (text("code"), text("severity"), at.map(|key| one[key].as_u64().unwrap() as usize), said)
        })
        .collect();
    found.sort();
    found
}

/// The diagnostics of the server, in the terms of `saoms check`: lines and characters from 1.
fn shown(diagnostics: &Value, text: &str) -> Found {
    let lines: Vec<&str> = text.split('\n').collect();
    let end = |place: &Value| {
        let line = place["line"].as_u64().unwrap() as usize;
        let mut left = place["character"].as_u64().unwrap() as usize;
        let mut column = 1;
        for letter in lines[line].chars() {
            if left == 0 {
                break;
            }
            left -= letter.len_utf16();
            column += 1;
        }
        [line + 1, column]
    };
    let mut found: Found = diagnostics
        .as_array()
        .unwrap()
        .iter()
        .map(|one| {
            let severity = ["", "error", "warning", "note"][one["severity"].as_u64().unwrap() as usize];
            let [[a, b], [c, d]] = ["start", "end"].map(|key| end(&one["range"][key]));
            let text = |key: &str| one[key].as_str().unwrap().to_owned();
            (text("code"), severity.to_owned(), [a, b, c, d], text("message"))
        })
        .collect();
    found.sort();
    found
}

/// Types so much into a file beside others, and compares after each fifth of it.
fn session(file: &str, others: &[&str], keystrokes: usize, seed: u64) {
    let composites = Path::new(env!("CARGO_MANIFEST_DIR")).join("composites");
    let read = |name: &str| fs::read_to_string(composites.join(name)).unwrap();
    let name = Path::new(file).file_name().unwrap().to_str().unwrap();
    let mut text = read(file);
    let texts: Vec<(&str, String)> = others.iter().map(|other| (*other, read(other))).collect();
    let files: Vec<(&str, &str)> = texts.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let mut editor = Editor::started(&format!("random-{name}"), &files);
    fs::write(editor.folder.join(name), &text).unwrap();
    editor.open(name, &text);
    let (mut chance, mut version) = (Chance(seed), 1);
    for round in 0..5 {
        for _ in 0..keystrokes / 5 {
            for Keystroke { start, end, new } in typed(&text, &mut chance) {
                let range = json!({ "start": place(&text, start), "end": place(&text, end) });
                version += 1;
                editor.change(name, version, json!([{ "range": range, "text": new }]));
                text.replace_range(start..end, &new);
            }
        }
        // A blank without meaning makes sure that the text is a new one.
        version += 1;
        let end = place(&text, text.len());
        editor.change(name, version, json!([{ "range": { "start": end, "end": end }, "text": " " }]));
        text.push(' ');
        let diagnostics = editor.diagnostics_of(name, version);
        fs::write(editor.folder.join(name), &text).unwrap();
        let expected = checked(&editor.folder, name);
        assert_eq!(shown(&diagnostics, &text), expected, "{file}, round {round}");
        assert!(round < 4 || !expected.is_empty(), "{file} is not disturbed");
    }
    assert_eq!(editor.end(), 0);
}

#[test]
fn what_is_shown_in_the_end_is_what_a_check_finds() {
    session("airport.composite", &[], 30, 0x5eed_0001);
    session("hangar.composite", &["hangar.csv"], 25, 0x5eed_0002);
    session("hangar.csv", &["hangar.composite"], 20, 0x5eed_0003);
    session("manual/robotenvironment-wired.composite", &[], 25, 0x5eed_0004);
}
