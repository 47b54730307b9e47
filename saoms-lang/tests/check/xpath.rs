//! Sources that are more than a path: XPath 1.0.

use std::fmt::Write as _;

use expect_test::expect;

use crate::properties::robot;
use crate::support::{fleet, nested, outcome, part, shown};

const BAYS: &str = r#"<property name="b"><bays xmlns="urn:x" unit="m"><bay id="a"><x>3</x><y>4</y></bay><bay id="b/c"><x>5</x></bay><bay> 7 <x> 8  9 </x></bay></bays></property>
<property name="many" many="true"><value>1</value><value>2</value><value>20</value></property>
<property name="s">Hall</property><property name="nothing"/>
<property name="places" element="p:place" many="true" xmlns:p="urn:p"><p:place xmlns=""><x>1</x></p:place><p:place xmlns=""><x>2</x></p:place></property>
"#;

/// What a robot's ID comes to with these sources, or what is wrong with them.
fn ids(sources: &[&str]) -> String {
    let mut all = String::new();
    for source in sources {
        let robot = format!(
            "<component name=\"R\"><implementation.java class=\"example.Robot\"/><property name=\"ID\" source=\"{source}\"/><property name=\"period\">1</property><property name=\"number\">1</property></component>"
        );
        let found = outcome(&[&part("fleet", "", &format!("{BAYS}{robot}"))], &[]);
        let lines: Vec<&str> = found.lines().filter(|line| !line.contains("S2026")).collect();
        let told = lines.iter().position(|line| line.contains(" error "));
        let told: Option<String> = told.map(|from| {
            let end = lines[from + 1..].iter().position(|line| !line.starts_with(' ')).unwrap_or(lines.len());
            lines[from..lines.len().min(from + 1 + end)].join("\n    ")
        });
        let value = || {
            found
                .split("ID=")
                .nth(1)
                .and_then(|rest| rest.split(" number").next())
                .unwrap_or("nothing")
                .to_owned()
        };
        let _ = writeln!(all, "{source}: {}", told.unwrap_or_else(value));
    }
    all
}

#[test]
fn sources_can_be_any_xpath() {
    expect![[r#"
        count($b/bay): Text("3")
        count($b//x) + count($many): Text("6")
        concat($s, '-', $b/bay[2]/x): Text("Hall-5")
        concat($s, ' ', $many[2]): Text("Hall 2")
        $b/bay[position() &lt; 2]/x: Text("3")
        $b/bay[position()=last()]/x: Text("8  9")
        $b/bay[last() - 1]/x: Text("5")
        $b/bay[x &gt; 3][1]/@id: Text("b/c")
        $b/bay[x != 3 and @id]/x: Text("5")
        $b/bay[not(@id)]/text(): Text("7")
        $b/bay[@id = 'a']/following-sibling::bay[1]/x: Text("5")
        $b/bay[2]/../@unit: Text("m")
        $b/bay[2]/preceding-sibling::*[1]/y: Text("4")
        string($b/bay[1]): Text("34")
        normalize-space($b/bay[3]/x): Text("8 9")
        normalize-space(string($b/p:bay[3]/p:x)): Text("8 9")
        substring($s, 2, 2): Text("al")
        substring-after($b/bay[2]/@id, '/'): Text("c")
        translate($s, 'Hl', 'hL'): Text("haLL")
        sum($many): Text("23")
        sum($b/bay/x[. &lt; 6]) div 2: Text("4")
        7 mod 4 * 2 - -1: 6:93-109 error S2023: `7 mod 4 * 2 - -1` names no property of the composite
              help: write `$name`, or `$name/part` for a part of a complex property
        $many[. &gt; 10]: Text("20")
        $many[position() = 2]: Text("2")
        ($b/bay | $b//y)[2]: Text("4")
        ($many | $b/bay[1]/x)[last()]: Text("3")
        string-length($s) * 2: Text("8")
        $s = 'Hall' or $nothing: Text("true")
        boolean($nothing): Text("false")
        concat($nothing, 'x'): Text("x")
        $nothing[position() = 1]: 6:93-117 error S3006: the property `ID` has no value: its source has none
              4:51-58 declared here, without a value
              help: write it in the file, or give `--set nothing=...`
        local-name($b/*/*[1]): Text("bay")
        name($b/bay/@*): Text("id")
        $b/bay[starts-with(@id, 'b')]/x: Text("5")
        $b//bay[contains(@id, '/')]/self::bay/x: Text("5")
        $b/descendant::x[2]: Text("5")
        $b/bay[count(*) = 2]/child::y: Text("4")
        $places[position() = 2]/x: Text("2")
        round(2.5) + floor(-0.5) + ceiling(0.2) + number('x1'): Text("NaN")
        number('12.50'): Text("12.5")
        1 div 0: 6:93-100 error S2023: `1 div 0` names no property of the composite
              help: write `$name`, or `$name/part` for a part of a complex property
        'text': 6:93-99 error S2023: `'text'` names no property of the composite
              help: write `$name`, or `$name/part` for a part of a complex property
        $b/bay[y][1]/y/ancestor::bay/@id: Text("a")
    "#]]
    .assert_eq(&ids(&[
        "count($b/bay)",
        "count($b//x) + count($many)",
        "concat($s, '-', $b/bay[2]/x)",
        "concat($s, ' ', $many[2])",
        "$b/bay[position() &lt; 2]/x",
        "$b/bay[position()=last()]/x",
        "$b/bay[last() - 1]/x",
        "$b/bay[x &gt; 3][1]/@id",
        "$b/bay[x != 3 and @id]/x",
        "$b/bay[not(@id)]/text()",
        "$b/bay[@id = 'a']/following-sibling::bay[1]/x",
        "$b/bay[2]/../@unit",
        "$b/bay[2]/preceding-sibling::*[1]/y",
        "string($b/bay[1])",
        "normalize-space($b/bay[3]/x)",
        "normalize-space(string($b/p:bay[3]/p:x))",
        "substring($s, 2, 2)",
        "substring-after($b/bay[2]/@id, '/')",
        "translate($s, 'Hl', 'hL')",
        "sum($many)",
        "sum($b/bay/x[. &lt; 6]) div 2",
        "7 mod 4 * 2 - -1",
        "$many[. &gt; 10]",
        "$many[position() = 2]",
        "($b/bay | $b//y)[2]",
        "($many | $b/bay[1]/x)[last()]",
        "string-length($s) * 2",
        "$s = 'Hall' or $nothing",
        "boolean($nothing)",
        "concat($nothing, 'x')",
        "$nothing[position() = 1]",
        "local-name($b/*/*[1])",
        "name($b/bay/@*)",
        "$b/bay[starts-with(@id, 'b')]/x",
        "$b//bay[contains(@id, '/')]/self::bay/x",
        "$b/descendant::x[2]",
        "$b/bay[count(*) = 2]/child::y",
        "$places[position() = 2]/x",
        "round(2.5) + floor(-0.5) + ceiling(0.2) + number('x1')",
        "number('12.50')",
        "1 div 0",
        "'text'",
        "$b/bay[y][1]/y/ancestor::bay/@id",
    ]));
}

#[test]
fn what_is_no_xpath_says_where() {
    expect![[r#"
        cuont($b/bay): 6:93-98 error S2023: there is no function `cuont` in XPath 1.0
              help: a `source` is `$name`, a path from there as `$name/part[2]/@attribute`, or another XPath 1.0
              fix: replace `cuont` with `count` [6:93-98 "count"]
        count($b/bay: 6:105-105 error S2023: `)` is expected here
              help: a `source` is `$name`, a path from there as `$name/part[2]/@attribute`, or another XPath 1.0
        count(): 6:93-100 error S2023: `count` takes one argument, and here are 0
        count($s, $b): 6:93-106 error S2023: `count` takes one argument, and here are 2
        count('x'): 6:93-103 error S2023: `count` takes parts of a property, and not a simple value
        $b/bay[position() &lt; ]/x: 6:116-117 error S2023: a value is missing: `$name`, a path, a text in quotes or a number
              help: a `source` is `$name`, a path from there as `$name/part[2]/@attribute`, or another XPath 1.0
        $b/bay[x=3: 6:103-103 error S2023: `]` is expected here
              help: a `source` is `$name`, a path from there as `$name/part[2]/@attribute`, or another XPath 1.0
        $b/bay[position() &gt; 7]/x: 6:96-118 error S2023: no part here is `bay[position() > 7]`
        concat($sa, 'x'): 6:101-103 error S2024: the composite has no property `sa`
              fix: replace `sa` with `s` [6:101-103 "s"]
        $b/axis::bay[x &gt; 1]: 6:96-100 error S2023: there is no axis `axis`
              help: a `source` is `$name`, a path from there as `$name/part[2]/@attribute`, or another XPath 1.0
        concat('a, $s): 6:100-101 error S2023: the text after ' is not closed
              help: a `source` is `$name`, a path from there as `$name/part[2]/@attribute`, or another XPath 1.0
        $b/bay[x &gt; 1]/z: 6:110-111 error S2023: there is no part `z`; the parts are `x` and `y`
        $b/bay[x &gt; 1]/@unit: 6:110-115 error S2023: there is no part `@unit`; the parts are `id`
        bay[1] + $s: 6:93-99 error S2023: a path starts at a property: `$name/...`
        /b/bay[$s]: 6:93-94 error S2023: a path starts at a property: `$name/...`
        $b/bay[1]#: 6:102-103 error S2023: `#` means nothing here
              help: a `source` is `$name`, a path from there as `$name/part[2]/@attribute`, or another XPath 1.0
        $many[position() = 4]: 6:98-114 error S2023: the property has 3 values
        $b/bay[x eq 3]: 6:102-104 error S2023: `]` is expected here
              help: a `source` is `$name`, a path from there as `$name/part[2]/@attribute`, or another XPath 1.0
        concat($s, 'x')/y: 6:93-108 error S2023: this is a simple value: there are no parts in it
    "#]].assert_eq(&ids(&[
        "cuont($b/bay)",
        "count($b/bay",
        "count()",
        "count($s, $b)",
        "count('x')",
        "$b/bay[position() &lt; ]/x",
        "$b/bay[x=3",
        "$b/bay[position() &gt; 7]/x",
        "concat($sa, 'x')",
        "$b/axis::bay[x &gt; 1]",
        "concat('a, $s)",
        "$b/bay[x &gt; 1]/z",
        "$b/bay[x &gt; 1]/@unit",
        "bay[1] + $s",
        "/b/bay[$s]",
        "$b/bay[1]#",
        "$many[position() = 4]",
        "$b/bay[x eq 3]",
        "concat($s, 'x')/y",
    ]));
    // Another program may have further functions.
    let text = part(
        "fleet",
        "",
        "<property name=\"s\">1</property><component name=\"R\"><implementation.java class=\"x.Y\"/><property name=\"a\" source=\"x:cut($s)\"/></component>",
    );
    let (_, found, sources) = nested(&[&text], &[], true);
    let found: String = found.iter().map(|one| shown(one, &sources)).collect();
    expect![[r#"
        2:113-118 warning S2023: there is no function `x:cut` in XPath 1.0
          help: another program may understand it: it is taken as given
    "#]]
    .assert_eq(&found);
}

/// Each looks at everything: a thousand such sources are one too many, and say so in a moment.
#[test]
fn sources_that_would_take_for_ever_are_told() {
    let parts: String = (0..300).map(|place| format!("<i>{place}</i>")).collect();
    let sources: String = (0..3)
        .map(|place| {
            format!(
                "<component name=\"R{place}\"><implementation.java class=\"example.Robot\"/><property name=\"ID\" source=\"count($c//i[count(../i[count(../i[. &gt; {place}]) &gt; 0]) &gt; 0])\"/><property name=\"period\">1</property></component>"
            )
        })
        .collect();
    let fleet = part("fleet", "", &format!("<property name=\"c\"><all>{parts}</all></property>{sources}"));
    let found = outcome(&[&fleet], &[]);
    assert_eq!(
        found.matches("S2023: the sources of a check look at most at four million parts").count(),
        1,
        "{found}"
    );
}

#[test]
fn texts_that_are_added_are_told_how_they_are_joined() {
    expect![[r#"
        'Cart' + $s: 6:93-104 error S2023: `'Cart'` is no number, and `+` adds numbers: `concat(...)` joins texts
              fix: replace `'Cart' + $s` with `concat('Cart', $s)` [6:93-104 "concat(&apos;Cart&apos;, $s)"]
        $s + '-' + count($b/bay): 6:93-117 error S2023: `$s` is `Hall`, which is no number, and `+` adds numbers: `concat(...)` joins texts
              fix: replace `$s + '-' + count($b/bay)` with `concat($s, '-', count($b/bay))` [6:93-117 "concat($s, &apos;-&apos;, count($b/bay))"]
        1 + $many[2] + $b/bay[9]/x: 6:108-119 error S2023: `$b/bay[9]/x` leads to nothing, and `+` takes numbers
        concat('x', $s * 2): 6:105-107 error S2023: `$s` is `Hall`, which is no number, and `*` takes numbers
        -$s: 6:94-96 error S2023: `$s` is `Hall`, which is no number, and `-` takes numbers
        $s &lt; 'x' - 1: Text("false")
        number($s): Text("NaN")
        '7' + $many[2]: Text("9")
        translate('abca', 'aba', 'xyz'): Text("xycx")
    "#]]
    .assert_eq(&ids(&[
        "'Cart' + $s",
        "$s + '-' + count($b/bay)",
        "1 + $many[2] + $b/bay[9]/x",
        "concat('x', $s * 2)",
        "-$s",
        "$s &lt; 'x' - 1",
        "number($s)",
        "'7' + $many[2]",
        "translate('abca', 'aba', 'xyz')",
    ]));
}

#[test]
fn an_expression_has_an_end() {
    let long = format!("$s{}", " + 1".repeat(100_000));
    let found = ids(&[&long]);
    assert!(
        found.ends_with("error S2023: there are more than 1000 operators\n"),
        "{}",
        &found[found.len() - 200..]
    );
    // Each composite doubles what the one around it gives.
    let inner = |place: usize| {
        let inside = match place {
            25 => "<component name=\"R\"><implementation.java class=\"example.Robot\"/><property name=\"ID\" source=\"$p\"/><property name=\"period\">1</property></component>".to_owned(),
            _ => format!("<component name=\"C\"><implementation.composite name=\"t:c{}\"/><property name=\"p\" source=\"concat($p, $p)\"/></component>", place + 1),
        };
        part(&format!("c{place}"), "", &format!("<property name=\"p\">{}</property>{inside}", "x".repeat(32)))
    };
    let texts: Vec<String> = (0..=25).map(inner).collect();
    let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
    let found = outcome(&texts, &[]);
    let told = "error S2023: this makes a text of more than 1048576 bytes: one that is so long can stand in a `file`";
    assert!(found.contains(told), "{found}");
}

/// Values that are written beside each other are several, as those in `value` are.
#[test]
fn one_of_several_elements_is_asked_for_by_its_place() {
    let place = |x: u8| format!("<p:place xmlns=\"\"><x>{x}</x><y>4</y></p:place>");
    let beside = place(1) + &place(2);
    let listed = format!("<value>{}</value><value>{}</value>", place(1), place(2));
    for values in [beside, listed] {
        let all = format!(
            "<property name=\"places\" element=\"p:place\" many=\"true\" xmlns:p=\"urn:x\">{values}</property>{}",
            robot(
                "<property name=\"charger\" source=\"$places[2]\"/><property name=\"number\" source=\"$places[1]/x\"/><property name=\"speed\" source=\"$places[2]/x\"/>"
            )
        );
        expect![[r#"
            R (example.Robot001) ID=Text("R") number=Text("1") speed=Text("2") charger=Complex([("x", Text("2")), ("y", Text("4"))]) gps->
        "#]]
        .assert_eq(&outcome(&[&fleet(&all)], &[]));
    }
}
