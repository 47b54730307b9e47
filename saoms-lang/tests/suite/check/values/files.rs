//! Values from files beside the composite.

use std::fs;
use std::time::Duration;

use expect_test::expect;
use saoms_api::host::PropertyValue;
use saoms_api::host::declaration::Scalar;
use saoms_lang::assembly::Assembly;
use saoms_lang::load::MAX_SIZE;
use saoms_lang::project::Project;

use crate::check::support::{compiled, compiled_in, fleet};
use crate::check::values::properties::robot;

/// Writes the composite and files beside it, checks it from another folder, and gives what is wrong without that
/// folder's name.
pub(crate) fn checked(inside: &str, beside: &[(&str, &[u8])], max_size: u64) -> (Option<Assembly>, String) {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in beside {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    // The limit is for the files of values: the composite is not read from one.
    let text = Project::new().text(folder.path().join("fleet.composite").display().to_string(), fleet(inside));
    compiled_in(folder.path(), &text.max_size(max_size).allow_outside(true))
}

fn value(assembly: &Assembly, name: &str) -> PropertyValue {
    let values = &assembly.components[0].values;
    values.iter().find(|(given, _)| given == name).unwrap().1.clone()
}

fn integer(number: i128) -> PropertyValue {
    Scalar::Integer(number.into()).into()
}

#[test]
fn a_value_is_what_its_file_holds() {
    let inside = robot(
        "<property name=\"speed\" file=\"values/speed\"/>
<property name=\"number\"\n file=\" number.txt \"/>
<property name=\"grace\" file=\"grace.txt\"/>",
    );
    let files: [(&str, &[u8]); 3] =
        [("grace.txt", "\u{feff}  20ms\r\n".as_bytes()), ("number.txt", b"7"), ("values/speed", b"\n1.5")];
    let (assembly, found) = checked(&inside, &files, MAX_SIZE);
    assert_eq!(found, "");
    let assembly = assembly.unwrap();
    assert_eq!(value(&assembly, "grace"), Scalar::Duration(Duration::from_millis(20)).into());
    assert_eq!(value(&assembly, "number"), integer(7));
    assert_eq!(value(&assembly, "speed"), Scalar::Float(1.5).into());
}

#[test]
fn a_fault_in_a_file_is_shown_in_that_file() {
    let inside = robot("<property name=\"speed\" file=\"speed.txt\"/>\n<property name=\"grace\" file=\"empty\"/>");
    let (_, found) = checked(&inside, &[("speed.txt", b"\n  fast"), ("empty", b" \n")], MAX_SIZE);
    expect![[r#"
        speed.txt:2:3-7 error S3007: property `speed`: `fast` is not a number: expected a number from 0.0 to 2.5 [m/s]
          help: `speed`: How fast it drives; the default is `1.0`
        empty:1:1-1 error S3010: property `grace`: the value is empty: expected a duration (in ms, or with a unit: ns, us, ms, s, min, h)
          help: the default is `10ms`
    "#]]
    .assert_eq(&found);
}

#[test]
fn files_that_cannot_be_read_are_reported_where_they_are_named() {
    let inside = robot(
        "<property name=\"speed\" file=\"sped.txt\"/>
<property name=\"stops\" file=\"stops\"/>
<property name=\"colour\" file=\"colour\"/>
<property name=\"awake\" file=\"awake\"/>
<property name=\"grace\" file=\"grace\">20ms</property>
<property name=\"delay\" file=\"large\"/>",
    );
    let files: [(&str, &[u8]); 6] = [
        ("speed.txt", b"1"),
        ("stops/first", b"1"),
        ("colour", b"r\xe9d"),
        ("awake", b"\x7fELF\x02\x01\x01\0\0\0"),
        ("grace", b"20ms"),
        ("large", &[b'1'; 60]),
    ];
    let (_, found) = checked(&inside, &files, 50);
    expect![[r#"
        3:30-38 error S0001: there is no such file
          help: the full path is `sped.txt`
          help: there is `speed.txt`
        4:30-35 error S0002: found a folder, expected a file
        5:31-37 error S0007: the byte 0xE9 is not valid UTF-8
          help: if the file is in Windows-1252 or Latin-1, convert it: `iconv -f WINDOWS-1252 -t UTF-8 colour`; until then the file cannot be checked
          help: it is in line 1, column 2 of `colour`
        6:30-35 error S0006: the file is a program or library, not text
          help: the value of a property is a text in UTF-8; save a spreadsheet as CSV
        7:30-35 error S3012: the property `grace` is given a value in two ways
          7:37-41 the other value
          help: write it in one way: as text inside, as the attribute `value`, as `<value>` elements, or in a `file`
        8:30-35 error S0004: the file has 60 bytes, and the limit is 50 bytes
          help: the limit is set with `--max-size`
    "#]]
    .assert_eq(&found);
}

/// SCA takes a URI (ASM50045).
#[test]
fn files_are_named_by_uris() {
    let one = |file: &str| {
        let files: [(&str, &[u8]); 3] = [("my speed.txt", b"1.5"), ("50%20.txt", b"2.0"), ("50 .txt", b"0")];
        let (assembly, found) =
            checked(&robot(&format!("<property name=\"speed\" file=\"{file}\"/>")), &files, MAX_SIZE);
        assembly.map_or(found, |assembly| format!("{:?}", value(&assembly, "speed")))
    };
    assert_eq!(one("my%20speed.txt"), "Float(1.5)");
    assert_eq!(one("my speed.txt"), "Float(1.5)");
    assert_eq!(one("50%20.txt"), "Float(2.0)", "a file of that very name");
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a b"), "0.5").unwrap();
    let path = folder.path().display();
    for scheme in ["file://", "file://localhost", "FILE:"] {
        assert_eq!(one(&format!("{scheme}{path}/a%20b")), "Float(0.5)");
    }
    let wrong = ["http://x/y.txt", "file://other/y.txt", "file:///nowhere/y%41", "no/%zz.txt", "%ff"];
    expect![[r#"
        3:30-44 error S0003: `http://x/y.txt` is not read: values come from files on this machine
          help: keep the file beside the composite, and name it by its path from there
        3:30-48 error S0003: `file://other/y.txt` is a file of another machine
          help: keep the file beside the composite, and name it by its path from there
        3:30-50 error S0001: there is no such file
          help: the full path is `/nowhere/yA`
          help: there is no folder `/nowhere`
        3:30-40 error S0001: there is no such file
          help: the full path is `no/%zz.txt`
          help: there is no folder `no`
        3:30-33 error S0001: there is no such file
          help: the full path is `%ff`
    "#]]
    .assert_eq(&wrong.map(one).concat());
}

#[test]
fn a_component_type_gives_the_values_that_components_do_not() {
    let described = |speed: &str| {
        format!(
            "<componentType xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912'>\n<property name='speed'>{speed}</property>\n<property name='grace'/></componentType>"
        )
    };
    let outcome = |speed: &str| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("Robot001.componentType"), described(speed)).unwrap();
        let path = folder.path().join("fleet.composite");
        let own = robot("<property name=\"speed\">0.5</property>").replace("name=\"R\"", "name=\"Own\"");
        fs::write(&path, fleet(&(robot("") + &own.replace(">R<", ">Own<")))).unwrap();
        let (assembly, found) = compiled_in(folder.path(), &Project::new().file(path));
        let speeds = assembly.map(|assembly| {
            let all = assembly.components.into_iter().map(|one| one.values);
            all.map(|values| values.into_iter().find(|(name, _)| name == "speed").map(|(_, value)| value)).collect()
        });
        (speeds, found)
    };
    let values: Vec<_> = [0.75, 0.5].map(|speed| Some(PropertyValue::from(Scalar::Float(speed)))).into();
    assert_eq!(outcome("0.75"), (Some(values), String::new()));
    let (speeds, found) = outcome("fast");
    assert_eq!(speeds, None);
    expect![[r#"
        Robot001.componentType:2:24-28 error S3007: property `speed`: `fast` is not a number: expected a number from 0.0 to 2.5 [m/s]
          2:18-19 used here as `speed`
          help: `speed`: How fast it drives; the default is `1.0`
    "#]]
    .assert_eq(&found);
}

#[test]
fn a_file_of_a_component_that_is_taken_as_given_may_come_with_it() {
    let inside = r#"<component name="A"><implementation.java class="other.A"/><property name="p" file="none.txt"/></component>
<component name="R"><implementation.java class="example.Robot"/><property name="ID">R</property>
<property name="period">1s</property><property name="speed" file="none.txt"/></component>"#;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fleet.composite");
    fs::write(&path, fleet(inside)).unwrap();
    let found = |assume_classes| {
        let project = Project::new().file(&path).assume_classes(assume_classes);
        let (_, all, sources) = compiled(&project);
        let missing = all.iter().filter(|one| one.code.id == "S0001");
        missing
            .map(|one| {
                let line = sources.get(one.location.file).line_column(one.location.span.start).line;
                format!("{line} {}\n", one.severity.name())
            })
            .collect::<String>()
    };
    assert_eq!(found(true), "2 warning\n4 error\n");
    assert_eq!(found(false), "2 error\n4 error\n");
}

#[test]
fn values_of_a_file_are_in_elements() {
    let inside = robot(
        "<property name=\"number\" file=\"number.xml\"/>
<property name=\"stops\" file=\"stops.xml\"/>
<property name=\"charger\" file=\"charger.xml\"/>",
    );
    let values = |inside: &str| {
        format!(
            "<?xml version='1.0'?>\n<s:values xmlns:s='http://docs.oasis-open.org/ns/opencsa/sca/200912'>{inside}</s:values>"
        )
    };
    let number = values("\n<s:value> 7 </s:value>");
    let outcome = |stops: &str, charger: &str| {
        let files: [(&str, &[u8]); 3] =
            [("number.xml", number.as_bytes()), ("stops.xml", stops.as_bytes()), ("charger.xml", charger.as_bytes())];
        checked(&inside, &files, MAX_SIZE)
    };
    let stops = values("<s:value>1</s:value><s:value>2</s:value>");
    for charger in [values("<s:value><x>3</x></s:value>"), "<at><x>3</x></at>".to_owned(), "<x>3</x>".to_owned()] {
        let (assembly, found) = outcome(&stops, &charger);
        assert_eq!(found, "");
        let assembly = assembly.unwrap();
        assert_eq!(value(&assembly, "number"), integer(7));
        assert_eq!(value(&assembly, "stops"), PropertyValue::Many([integer(1), integer(2)].into()));
        assert_eq!(value(&assembly, "charger"), PropertyValue::Complex([("x".into(), integer(3))].into()));
    }
    let (_, found) = outcome(&values("<s:value>1</s:value><s:value>two</s:value>"), "<at>\n<x>three</x><z>4</z></at>");
    expect![[r#"
        stops.xml:2:99-102 error S3007: property `stops`: `two` is not a whole number: expected a whole number from 0 to 65535
        charger.xml:2:4-9 error S3007: property `charger.x`: `three` is not a whole number: expected a whole number from -2147483648 to 2147483647
        charger.xml:2:14-15 error S3004: the property `charger` has no part `z`
          help: its parts are `x` and `y`
          help: `charger`: Where it charges
    "#]].assert_eq(&found);
    for wrong in [
        values(""),
        values("\n7"),
        values("<s:vale>7</s:vale>"),
        values("<s:component/>"),
        values("<s:value>7</s:value><x>7</x>"),
        "<values><value>7</value></values>".to_owned(),
        values("<s:value>7</s:val>"),
    ] {
        let (_, found) = outcome(&wrong, "<x>3</x>");
        assert!(found.starts_with("stops.xml:") && found.matches(" error ").count() == 1, "{wrong}: {found}");
    }
}

/// The content of a text is checked by the component that takes it.
#[test]
fn a_text_may_look_like_xml() {
    for text in ["<robot>", "<robot>7</robot>", "< 7"] {
        let (_, found) =
            checked(&robot("<property name=\"grace\" file=\"grace\"/>"), &[("grace", text.as_bytes())], MAX_SIZE);
        assert!(found.starts_with("grace:1:1-") && found.contains("S3007"), "{found}");
    }
}
