//! Slips that make a text no XML are reported together, and nothing false behind them.

use super::*;

/// A composite in which each line has its own slip: what is right, and what is written instead.
const LINES: &[(&str, &str)] = &[
    ("<composite xmlns='OASIS' name='c' targetNamespace='u'>", ""),
    ("<!-- some text -->", "<!-- some -- text -->"),
    ("<property name='text'>Research and Development", "<property name='text'>Research & Development"),
    ("</property>", "</properti>"),
    ("<property name='other' many='true'>", "<property name='other' many=true>"),
    ("<value>1</value></property>", "<value>&nbsp;1</value></property>"),
    ("<component name='A'>", "<component name='A' name='B'>"),
    ("<implementation.java class='x.A'/>", "<implementation.java class=\u{201c}x.A\u{201d}/>"),
    ("<property name='one' value='1'/>", "<property name='one' xsi:nil='true' value='1'/>"),
    ("<property name='two' value='2'/>", "<property name='two'value='2'/>"),
    ("<property name='three' value='3'/>", "<property name 'three' value='3'/>"),
    ("<property name='four' value='4'/>", "<property name: 'four' value='4'/>"),
    ("<property name='five' value='5'/>", "<property name='five', value='5'/>"),
    ("<property name='six' value='6'/>", "<property name='six value='6'/>"),
    ("<property name='seven' value='7'/>", "<property foo:is='x' name='seven' value='7'/>"),
    ("<property name='eight' value='8'/>", "<property name='eight' value='8 < 9'/>"),
    ("<property name='nine' value='9'/>", "<property name='nine' & value='9'/>"),
    ("<property name='ten' source='$text'/>", "<property name='ten' source='$text' wiredByImpl/>"),
    ("<property name='eleven' value='11'/>", "<property name='eleven' valeu='11'/>"),
    ("<reference name='r' target='B'/></component>", "<reference name='r' target='B' autowire='ja'/></component>"),
    ("<component name='B'>", "<component name='B' foo:is='x'>"),
    ("<implementation.java class='x.B'/></component>", "<implementation.java class='x.B'/></componnt>"),
    ("</composite>", ""),
];

/// The diagnostics of the composite with the slips of these lines, each without its column.
fn told(lines: &[usize]) -> Vec<String> {
    let written = |(place, (right, wrong)): (usize, &(&str, &str))| match lines.contains(&place) {
        true => (*wrong).to_owned(),
        false => right.replace("OASIS", OASIS),
    };
    let text: Vec<String> = LINES.iter().enumerate().map(written).collect();
    let (composite, told) = loaded(&text.join("\n"));
    let components: Vec<String> = composite.unwrap().components.iter().map(|one| one.name.to_string()).collect();
    assert_eq!(components, ["A", "B"], "{told}");
    let without_column = |line: &str| {
        let (place, rest) = line.split_once(' ').unwrap();
        format!("{} {rest}", place.split(':').next().unwrap())
    };
    told.lines().map(without_column).collect()
}

#[test]
fn each_slip_is_told() {
    let wrong = |place: &usize| !LINES[*place].1.is_empty();
    let all: Vec<String> = (0..LINES.len()).filter(wrong).flat_map(|place| told(&[place])).collect();
    expect_test::expect![[r#"
        2 [--] error S0101 `--` inside a comment | write single dashes
        3 [&] error S0109 `&` must start a reference such as `&amp;` | replace `&` with `&amp;`
        4 [</properti>] error S0102 `</properti>` found where `</property>` is expected | replace it with `</property>`
        5 [true] error S0105 the value of `many` is not in quotes | put it in quotes
        6 [&nbsp;] error S0109 unknown entity `&nbsp;`
        7 [name] error S0106 the attribute `name` is given twice | remove the second `name`
        8 [“x.A”] error S0105 `“` is not a quote of XML: write values between two `"` | replace it with `"x.A"`
        9 [xsi] error S0112 the prefix `xsi` is not declared | declare it in the root element: `xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"`
        10 [v] error S0105 white space is missing between two attributes | insert a blank
        11 [name] error S0105 the attribute `name` has no value | insert `=`
        12 [:] error S0105 found `:` between `name` and its value, expected `=` | replace `:` with `=`
        13 [,] error S0101 `,` is misplaced in the start tag of `property` | remove `,`
        14 ['six] error S0105 this value has no closing quote before `value` | close it with `'`
        15 [foo] error S0112 the prefix `foo` is not declared
        16 [<] error S0105 `<` in the value of `value` | replace `<` with `&lt;`
        17 [&] error S0101 `&` is misplaced in the start tag of `property`
        18 [wiredByImpl] error S0105 the attribute `wiredByImpl` has no value
        19 [valeu] error S1007 `property` has no attribute `valeu` | replace `valeu` with `value`
        20 [ja] error S1011 `autowire` is `ja`, expected `true` or `false`
        21 [foo] error S0112 the prefix `foo` is not declared
        22 [</componnt>] error S0102 `</componnt>` found where `</component>` is expected | replace it with `</component>`
    "#]].assert_eq(&(all.join("\n") + "\n"));
}

#[test]
fn slips_are_told_together_as_each_is_alone() {
    let wrong: Vec<usize> = (0..LINES.len()).filter(|place| !LINES[*place].1.is_empty()).collect();
    let alone = |place: usize| if wrong.contains(&place) { told(&[place]) } else { Vec::new() };
    let alone: Vec<Vec<String>> = (0..LINES.len()).map(alone).collect();
    let together = |places: &[usize]| {
        let mut expected: Vec<String> = Vec::new();
        for one in places.iter().flat_map(|place| &alone[*place]) {
            // A prefix is reported once.
            let is_prefix = |one: &str| one.contains("[foo]");
            if !(is_prefix(one) && expected.iter().any(|other| is_prefix(other))) {
                expected.push(one.clone());
            }
        }
        assert_eq!(told(places), expected, "{places:?}");
    };
    for (at, one) in wrong.iter().enumerate() {
        for (next, other) in wrong.iter().enumerate().skip(at + 1) {
            together(&[*one, *other]);
            for third in &wrong[next + 1..] {
                together(&[*one, *other, *third]);
            }
        }
    }
    together(&wrong);
}
