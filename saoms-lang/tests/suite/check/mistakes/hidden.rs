//! Characters that nobody sees, and those that look like others: each is told once, with its number and its place.

use expect_test::expect;

use crate::check::mistakes::slips::{GPS, of, robot};
use crate::check::support::{nested, outcome, part, shown};
use crate::check::values::files::checked;

const RIGHT: &str = r#"<property name="number" source="$n"/><reference name="gps" target="G"/>"#;

/// The diagnostics of a robot and a service, with one text replaced by others, each on its own.
fn with(right: &str, wrong: &[&str]) -> String {
    let whole = format!("<property name=\"n\" type=\"xsd:int\">7</property>\n{GPS}\n{}", robot("R", RIGHT));
    let whole = part("fleet", "xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\"", &whole);
    assert!(whole.contains(right), "{right}");
    wrong.iter().map(|wrong| outcome(&[&whole.replacen(right, wrong, 1)], &[]) + "\n").collect()
}

#[test]
fn in_values_that_are_right_otherwise() {
    expect![[r#"
        4:85-87 warning S1016: `R` contains U+200B, which nobody sees
          fix: remove this character [4:86-87 ""]
        G (example.Gps) other->
        R (example.Robot) ID=Text("R\u{200b}") number=Integer(7) gps->G/position

        4:85-87 warning S1016: `R` contains U+FEFF, which nobody sees
          fix: remove this character [4:85-86 ""]
        G (example.Gps) other->
        R (example.Robot) ID=Text("\u{feff}R") number=Integer(7) gps->G/position

        4:85-89 warning S1016: `Rx` contains U+2060, which nobody sees, and 1 more such characters
          fix: write it without these characters [4:86-87 ""] [4:88-89 ""]
        G (example.Gps) other->
        R (example.Robot) ID=Text("R\u{2060}x\u{ad}") number=Integer(7) gps->G/position

        4:85-88 warning S1016: `R 1` contains U+00A0, which looks like a blank
          fix: remove this character [4:86-87 ""]
        G (example.Gps) other->
        R (example.Robot) ID=Text("R\u{a0}1") number=Integer(7) gps->G/position

        4:85-88 warning S1016: `Rob` contains U+043E, which looks like `o`
          fix: replace this character with `o` [4:86-87 "o"]
        G (example.Gps) other->
        R (example.Robot) ID=Text("Rоb") number=Integer(7) gps->G/position

    "#]]
    .assert_eq(&with(">R<", &[">R\u{200b}<", ">\u{feff}R<", ">R\u{2060}x\u{ad}<", ">R\u{a0}1<", ">R\u{43e}b<"]));
    // What is written in another alphabet is what it seems to be, and so is a text of several words.
    expect![[r#"
        G (example.Gps) other->
        R (example.Robot) ID=Text("Мир") number=Integer(7) gps->G/position

        G (example.Gps) other->
        R (example.Robot) ID=Text("a\u{a0}b c") number=Integer(7) gps->G/position

        G (example.Gps) other->
        R (example.Robot) ID=Text("Röb") number=Integer(7) gps->G/position

        G (example.Gps) other->
        R (example.Robot) ID=Text("می\u{200c}خ") number=Integer(7) gps->G/position

    "#]]
    .assert_eq(&with(
        ">R<",
        &[">\u{41c}\u{438}\u{440}<", ">a\u{a0}b c<", ">R\u{f6}b<", ">\u{645}\u{6cc}\u{200c}\u{62e}<"],
    ));
}

#[test]
fn in_names_and_what_leads_to_them() {
    expect![[r#"
        5:68-70 error S2011: there is no component `G\u{200b}`
          help: `G` contains U+200B, which nobody sees
          fix: replace `G\u{200b}` with `G` [5:68-70 "G"]

        5:68-70 error S2011: there is no component `G `
          help: `G ` contains U+00A0, which looks like a blank
          fix: replace `G ` with `G` [5:68-70 "G"]

        5:68-69 error S2011: there is no component `А`
          help: `A` contains U+0410, which looks like `A`
          help: the components are `G`
          fix: replace this character with `A` [5:68-69 "A"]

    "#]]
    .assert_eq(&with("target=\"G\"", &["target=\"G\u{200b}\"", "target=\"G\u{a0}\"", "target=\"\u{410}\""]));
    expect![[r#"
        3:18-20 error S1011: the name `G` contains the invisible character U+200B
          fix: remove that character [3:18-20 "G"]

        3:18-20 error S1011: the name `G` contains the invisible character U+FEFF
          fix: remove that character [3:18-20 "G"]

        5:68-69 error S2011: there is no component `G`
          help: the components are `Н`

    "#]]
    .assert_eq(&with("name=\"G\"", &["name=\"G\u{200b}\"", "name=\"G\u{feff}\"", "name=\"\u{41d}\""]));
    expect![[r#"
        5:17-24 error S1011: the name `number` contains the invisible character U+200B
          fix: remove that character [5:17-24 "number"]

        5:17-23 error S3004: class `example.Robot` has no property `numbеr`
          help: `number` contains U+0435, which looks like `e`
          fix: replace `numbеr` with `number` [5:17-23 "number"]

        5:17-24 error S3004: class `example.Robot` has no property `num ber`
          help: `num ber` contains U+00A0, which looks like a blank
          fix: replace `num ber` with `number` [5:17-24 "number"]

    "#]]
    .assert_eq(&with("\"number\"", &["\"num\u{200b}ber\"", "\"numb\u{435}r\"", "\"num\u{a0}ber\""]));
    expect![[r#"
        5:33-36 error S2023: `$n\u{200b}` is not the path of a property
          help: `n` contains U+200B, which nobody sees
          help: a `source` is `$name`, `$name[2]`, or a path from there, `$name/step/step`: write a step as `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
          fix: remove this character [5:35-36 ""]

        5:33-36 error S2023: `$\u{feff}n` is not the path of a property
          help: `n` contains U+FEFF, which nobody sees
          help: a `source` is `$name`, `$name[2]`, or a path from there, `$name/step/step`: write a step as `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
          fix: remove this character [5:34-35 ""]

    "#]].assert_eq(&with("\"$n\"", &["\"$n\u{200b}\"", "\"$\u{feff}n\""]));
    expect![[r#"
        3:49-61 error S3001: there is no class `example.G\u{200b}ps`
          help: `example.Gps` contains U+200B, which nobody sees
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          fix: replace `example.G\u{200b}ps` with `example.Gps` [3:49-61 "example.Gps"]

        3:49-60 error S3001: there is no class `еxample.Gps`
          help: `example.Gps` contains U+0435, which looks like `e`
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          fix: replace `еxample.Gps` with `example.Gps` [3:49-60 "example.Gps"]

    "#]].assert_eq(&with("example.Gps", &["example.G\u{200b}ps", "\u{435}xample.Gps"]));
    expect![[r#"
        2:35-37 error S3007: property `number`: `7\u{200b}` is not a whole number: expected a whole number from 1 to 99
          5:33-35 used here as `number`
          help: `7` contains U+200B, which nobody sees
          help: `number`: The number of the robot
          fix: remove this character [2:36-37 ""]

        2:35-37 error S2042: the property `n` has the type `xsd:int`: found `7 `, expected a whole number of 32 bits
          2:26-33 the type
          help: `7 ` contains U+00A0, which looks like a blank
          help: change the value, or the type
          fix: remove this character [2:36-37 ""]

        2:35-36 error S3007: property `number`: `７` is not a whole number: expected a whole number from 1 to 99
          5:33-35 used here as `number`
          help: `7` contains U+FF17, which looks like `7`
          help: `number`: The number of the robot
          fix: replace this character with `7` [2:35-36 "7"]

        2:35-37 error S3007: property `number`: `−7` is not a whole number: expected a whole number from 1 to 99
          5:33-35 used here as `number`
          help: `-7` contains U+2212, which looks like `-`
          help: `number`: The number of the robot
          fix: replace this character with `-` [2:35-36 "-"]

    "#]]
    .assert_eq(&with(">7<", &[">7\u{200b}<", ">7\u{a0}<", ">\u{ff17}<", ">\u{2212}7<"]));
}

#[test]
fn in_tags() {
    expect![[r#"
        3:6-7 error S0107: U+200B, which looks like nothing, in the name of an element
          fix: remove it [3:6-7 ""]

        3:6-7 error S0107: U+00A0, which looks like a blank, in the name of an element
          fix: replace it with a blank [3:6-7 " "]

        3:11-12 error S0107: U+200B, which looks like nothing, in the name of an element
          fix: replace it with a blank [3:11-12 " "]

        3:11-12 error S0107: U+00A0, which looks like a blank, in the name of an element
          fix: replace it with a blank [3:11-12 " "]

        3:12-16 error S1007: `component` has no attribute `nаme`
          help: `name` contains U+0430, which looks like `a`
          fix: replace `nаme` with `name` [3:12-16 "name"]

        3:2-11 error S1004: SCA 1.1 has no element `cоmponent`
          help: `component` contains U+043E, which looks like `o`
          fix: replace `cоmponent` with `component` [3:2-11 "component"]

    "#]]
    .assert_eq(&with(
        "<component name=\"G\"",
        &[
            "<comp\u{200b}onent name=\"G\"", "<comp\u{a0}onent name=\"G\"", "<component\u{200b}name=\"G\"",
            "<component\u{a0}name=\"G\"", "<component n\u{430}me=\"G\"", "<c\u{43e}mponent name=\"G\"",
        ],
    ));
}

#[test]
fn in_the_names_of_other_composites() {
    let told = |outer: &str, inner: &str| {
        let outer = part(
            "fleet",
            "",
            &format!("<component name=\"In\"><implementation.composite name=\"{outer}\"/></component>"),
        );
        let (_, found, sources) = nested(&[&outer, &part(inner, "", GPS)], &[], false);
        found.iter().map(|one| shown(one, &sources)).collect::<String>()
    };
    expect![[r#"
        2:54-61 error S2031: there is no composite `innеr` in the namespace `urn:t`
          help: `t:inner` contains U+0435, which looks like `e`
          help: name the file of that composite in the command as well
          fix: replace `t:innеr` with `t:inner` [2:54-61 "t:inner"]
    "#]]
    .assert_eq(&told("t:inn\u{435}r", "inner"));
    expect![[r#"
        2:54-61 error S2031: there is no composite `inner` in the namespace `urn:t`
          innеr:1:115-120 `inner` contains U+0435, which looks like `e`
          help: the name `t:inner` of another composite contains U+0435, which looks like `e`: write it without
          help: name the file of that composite in the command as well
          fix: replace this character with `e` [innеr:1:118-119 "e"]
    "#]]
    .assert_eq(&told("t:inner", "inn\u{435}r"));
}

#[test]
fn in_tables_and_other_files() {
    let robots = "<component name=\"R${index}\" xmlns:saoms=\"urn:saoms:1\" saoms:count=\"2\" saoms:overrides=\"robots.csv\"><implementation.java class=\"example.Robot\"/><property name=\"ID\">R${index}</property><property name=\"period\">1</property><property name=\"number\">${index}</property></component>";
    let with = |table: &str| checked(robots, &[("robots.csv", table.as_bytes())], 1000).1;
    expect![[r#"
        robots.csv:2:3-6 warning S1016: `R7` contains U+200B, which nobody sees
          fix: remove this character [robots.csv:2:4-5 ""]
        robots.csv:3:3-6 warning S1016: `R 8` contains U+00A0, which looks like a blank
          fix: remove this character [robots.csv:3:4-5 ""]
    "#]]
    .assert_eq(&with("index,ID\n1,R\u{200b}7\n2,R\u{a0}8\n"));
    expect![[r#"
        robots.csv:1:7-14 error S3004: class `example.Robot` has no property `num\u{200b}ber` (in `R1`, index 1)
          help: `number` contains U+200B, which nobody sees
          fix: replace `num\u{200b}ber` with `number` [robots.csv:1:7-14 "number"]
    "#]]
    .assert_eq(&with("index,num\u{200b}ber\n1,4\n"));
    expect![""].assert_eq(&with("\u{feff}index,number\n1,4\n"));
}

#[test]
fn dashes_in_place_of_a_minus_have_a_fix() {
    let with = |value: &str| {
        of(&robot("R${index}", &format!("<property name=\"number\">{value}</property>"))
            .replacen("<component", "<component saoms:count=\"1\"", 1))
    };
    expect![[r#"
        3:25-27 error S3007: property `number`: `−1` is not a whole number: expected a whole number from 1 to 99 (in `R1`, index 1)
          help: `-1` contains U+2212, which looks like `-`
          help: `number`: The number of the robot
          fix: replace this character with `-` [3:25-26 "-"]
        3:25-27 error S3007: property `number`: `–4` is not a whole number: expected a whole number from 1 to 99 (in `R1`, index 1)
          help: `-4` contains U+2013, which looks like `-`
          help: `number`: The number of the robot
          fix: replace this character with `-` [3:25-26 "-"]
        3:33-34 error S2045: unexpected `–` (in `R1`, index 1)
          help: `-` contains U+2013, which looks like `-`
          help: `docs/fleets.md` describes expressions
          fix: replace this character with `-` [3:33-34 "-"]
    "#]].assert_eq(&["\u{2212}1", "\u{2013}4", "${index \u{2013} 4}"].map(with).concat());
}
