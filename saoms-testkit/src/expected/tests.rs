use super::*;

/// The text after its comments were written for diagnostics in these lines.
fn written(text: &str, found: &[(u32, &str)], placement: Placement) -> String {
    let one = |(line, message): &(u32, &str)| Found {
        line: *line,
        severity: "error",
        code: "S1",
        message: (*message).to_owned(),
    };
    rewritten(text, &found.iter().map(one).collect::<Vec<_>>(), placement)
}

/// True if the written comments expect these diagnostics, and writing them again changes nothing.
fn is_met(text: &str, expected: &[(u32, &str)]) -> bool {
    let found: Vec<(u32, String)> =
        comments(text).into_iter().map(|one| (one.expectation.line, one.expectation.text)).collect();
    let again: Vec<(u32, &str)> = found.iter().map(|(line, text)| (*line, text.as_str())).collect();
    let mut sorted = again.clone();
    sorted.sort_unstable();
    sorted == expected && written(text, &again, Placement::Behind) == text
}

const FLEET: &str = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
  <component name="Robot1">
    <implementation.java class="saoms.Robot"/>
    <property name="ID">Robot1</property> <!--~ S9999 no such code -->
    <property name="batery">50</property>
    <property name="period"
      value="1us"/>
  </component>
</composite>
"#;

#[test]
fn differences_are_told_and_what_is_written_is_met() {
    let folder = tempfile::tempdir().unwrap();
    let broken = FLEET.split_inclusive('\n').next().unwrap().to_owned() + "<component name='b'\n";
    for (name, text, expected) in [
        (
            "wrong",
            FLEET,
            "4: - S9999 no such code\n5: + error S3004 class `saoms.Robot` has no property `batery`\n7: + error S3008 ",
        ),
        ("broken", &broken, "2: + error S0103 "),
        ("empty", "", "1: + error S0005 the file is empty"),
    ] {
        let path = folder.path().join(format!("{name}.composite"));
        fs::write(&path, text).unwrap();
        let fleet = Fleet::of_file(&path);
        let told = fleet.differences().unwrap_err().replace(&format!("{}:", path.display()), "");
        assert!(told.starts_with(expected), "{told}");
        // An empty file cannot expect anything: with a comment in it, it is not empty.
        let can = name != "empty";
        assert_eq!(fleet.update(&fleet.texts()), can, "{name}");
        assert_eq!(fleet.differences().is_ok(), can, "{name}");
        if !can {
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
    }
    let wrong = fs::read_to_string(folder.path().join("wrong.composite")).unwrap();
    assert!(!wrong.contains("S9999") && wrong.contains("    <!--~^ error S3004 class"), "{wrong}");
    assert_eq!(composites(folder.path()).len(), 3);
}

#[test]
fn a_comment_says_as_much_as_matters() {
    let of = |comment: &str| {
        let text = FLEET
            .replace("<!--~ S9999 no such code -->", "")
            .replace("50</property>", &format!("50</property>{comment}"));
        Fleet::of_text(text.replace("1us", "1s")).differences().err().unwrap_or_default()
    };
    for right in [
        "<!--~ S3004 -->",
        "<!--~error S3004 no property `batery`-->",
        "\n<!--~^S3004-->",
        "\n\n<!--~^2 S3004 has no\nproperty -->",
    ] {
        assert_eq!(of(right), "", "{right}");
    }
    for wrong in [
        "", "<!--~ warning S3004 -->", "<!--~ S3004 other -->", "<!--~^ S3004 -->", "<!--~ S3004 --><!--~ S3004 -->",
        "<!--~ -->",
    ] {
        assert_ne!(of(wrong), "", "{wrong}");
    }
}

#[test]
fn comments_go_behind_the_line_or_where_the_next_can_stand() {
    let text = "<a>\n  <b x='>\n'\n  />\n  <p>one\n two</p>\n</a>";
    let out = written(text, &[(2, "in a tag"), (5, "in text"), (7, "at the end"), (7, "again")], Placement::Behind);
    assert_eq!(
        out,
        "<a>\n  <b x='>\n'\n  />\n  <!--~^3 error S1 in a tag -->\n  <p>one\n two</p>\n <!--~^2 error S1 in text -->\n</a>\n\
         <!--~^ error S1 at the end -->\n<!--~^2 error S1 again -->\n"
    );
    assert!(is_met(&out, &[(2, "in a tag"), (6, "in text"), (9, "again"), (9, "at the end")]), "{out}");
}

#[test]
fn comments_that_were_there_are_gone_and_others_stay() {
    let text = "<a> <!--~ S9 old -->\n<!--~^ S9 old -->\n<!-- kept -->\n<b/>\n</a>\n";
    assert_eq!(
        written(text, &[(4, "new -- of a kind")], Placement::Behind),
        "<a>\n<!-- kept -->\n<b/>\n<!--~^ error S1 new -->\n</a>\n"
    );
    assert_eq!(written(text, &[], Placement::Behind), "<a>\n<!-- kept -->\n<b/>\n</a>\n");
}

#[test]
fn broken_texts_have_their_comments_at_an_end() {
    let text = "<?xml version='1.0'?>\n<a>\n<b";
    assert_eq!(
        written(text, &[(3, "no end")], Placement::End),
        "<?xml version='1.0'?>\n<a>\n<b\n<!--~^ error S1 no end -->\n"
    );
    let start = written(text, &[(3, "no end"), (2, "or here")], Placement::Start);
    assert_eq!(start, "<?xml version='1.0'?>\n<!--~v2 error S1 or here -->\n<!--~v2 error S1 no end -->\n<a>\n<b");
    let lines: Vec<u32> = comments(&start).iter().map(|one| one.expectation.line).collect();
    assert_eq!(lines, [4, 5]);
}

#[test]
fn any_lines_get_comments_that_are_about_them() {
    // Every choice of lines of a text, each once or twice.
    let text = "<a>\n<b/>\n<c\nd=''/>\n</a>\n";
    for chosen in 0..3_u32.pow(5) {
        let found: Vec<(u32, String)> = (1..=5_u32)
            .flat_map(|line| {
                let times = chosen / 3_u32.pow(line - 1) % 3;
                (0..times).map(move |time| (line, format!("{line}.{time}")))
            })
            .collect();
        let found: Vec<(u32, &str)> = found.iter().map(|(line, text)| (*line, text.as_str())).collect();
        for placement in Placement::ALL {
            let out = written(text, &found, placement);
            let all: Vec<&str> = out.lines().collect();
            let bare: Vec<&str> = all.iter().copied().filter(|line| !line.contains("<!--~")).collect();
            assert_eq!(bare.join("\n") + "\n", text);
            let expected = comments(&out);
            assert_eq!(expected.len(), found.len());
            for one in expected {
                let meant: usize = one.expectation.text.split('.').next().unwrap().parse().unwrap();
                assert_eq!(all[one.expectation.line as usize - 1], bare[meant - 1], "{out}");
            }
        }
    }
}
