//! Mistakes are reported together: one hides no other, and each is reported once.

use expect_test::expect;

use crate::check::support::{faults_of, fleet, outcome, part};

/// The diagnostics of a fleet with the prefix of SAOMS.
fn of(inside: &str) -> String {
    outcome(&[&part("fleet", "xmlns:saoms=\"urn:saoms:1\"", inside)], &[])
}

/// A robot with these attributes and this ID, in which four other things are wrong.
fn robot(attributes: &str, id: &str) -> String {
    format!(
        "<component {attributes}><implementation.java class=\"example.Robot\"/>
<property name=\"ID\">{id}</property><property name=\"period\">100x</property><property name=\"number\">1</property><property name=\"bat\">1</property>
<reference name=\"gps\" target=\"Nobody\"/></component>
<component name=\"C\"><implementation.java class=\"example.Conductor\"/><reference name=\"gps\" target=\"Nowhere\"/><reference name=\"wheels\" target=\"R2/move\"/></component>"
    )
}

#[test]
fn a_faulty_expression_hides_nothing_else() {
    let by_id = of(&robot("name=\"R${index}\" saoms:count=\"3\"", "R${inde}"));
    expect![[r#"
        3:24-28 error S2045: the composite has no property `inde` (in `R1`, index 1, and in 2 more)
          fix: replace `inde` with `index` [3:24-28 "index"]
        3:64-68 error S3007: property `period`: `100x` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h) (in `R1`, index 1)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        3:131-134 error S3004: class `example.Robot` has no property `bat` (in `R1`, index 1)
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `passwordFile`, `tlsCa`, `tlsCertificate`, `tlsKey`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `trigger`, `minimum`, `queue` and `loss`
        4:31-37 error S2011: there is no component `Nobody` (in `R1`, index 1)
          help: the components are `C` and `R*`
          help: add a component of the class `example.Gps`
        5:99-106 error S2011: there is no component `Nowhere`
          help: the components are `R*`
          help: add a component of the class `example.Gps`
    "#]].assert_eq(&by_id);
    let by_count = of(&robot("name=\"R${index}\" saoms:count=\"k\"", "R${index}"));
    expect![[r#"
        2:42-43 error S2045: the composite has no property `k`
          help: declare it: `<property name="...">...</property>` in the composite
        3:65-69 error S3007: property `period`: `100x` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h) (in `R1`, index 1)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        3:132-135 error S3004: class `example.Robot` has no property `bat` (in `R1`, index 1)
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `passwordFile`, `tlsCa`, `tlsCertificate`, `tlsKey`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `trigger`, `minimum`, `queue` and `loss`
        4:31-37 error S2011: there is no component `Nobody` (in `R1`, index 1)
          help: the components are `C` and `R*`
          help: add a component of the class `example.Gps`
        5:99-106 error S2011: there is no component `Nowhere`
          help: the components are `R*`
          help: add a component of the class `example.Gps`
    "#]].assert_eq(&by_count);
    let by_table = of(&robot("name=\"R${index}\" saoms:count=\"3\" saoms:overrides=\"none.csv\"", "R${index}"));
    expect![[r#"
        2:62-70 error S0003: the file was not read
        3:65-69 error S3007: property `period`: `100x` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h) (in `R1`, index 1)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        3:132-135 error S3004: class `example.Robot` has no property `bat` (in `R1`, index 1)
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `passwordFile`, `tlsCa`, `tlsCertificate`, `tlsKey`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `trigger`, `minimum`, `queue` and `loss`
        4:31-37 error S2011: there is no component `Nobody` (in `R1`, index 1)
          help: the components are `C` and `R*`
          help: add a component of the class `example.Gps`
        5:99-106 error S2011: there is no component `Nowhere`
          help: the components are `R*`
          help: add a component of the class `example.Gps`
    "#]].assert_eq(&by_table);
    let by_name = of(&robot("name=\"R${inde}\" saoms:count=\"3\"", "R${index}"));
    expect![[r#"
        2:21-25 error S2045: the composite has no property `inde` (in `R${inde}`, index 1, and in 2 more)
          fix: replace `inde` with `index` [2:21-25 "index"]
        3:65-69 error S3007: property `period`: `100x` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h) (in `R${inde}`, index 1)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        3:132-135 error S3004: class `example.Robot` has no property `bat` (in `R${inde}`, index 1)
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `passwordFile`, `tlsCa`, `tlsCertificate`, `tlsKey`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `trigger`, `minimum`, `queue` and `loss`
        4:31-37 error S2011: there is no component `Nobody` (in `R${inde}`, index 1)
          help: the components are `C` and `R*`
          help: add a component of the class `example.Gps`
        5:99-106 error S2011: there is no component `Nowhere`
          help: the components are `R*`
          help: add a component of the class `example.Gps`
    "#]].assert_eq(&by_name);
    let by_condition = of(&robot("name=\"R2\" saoms:if=\"bogus\"", "R2"));
    expect![[r#"
        2:32-37 error S2045: the composite has no property `bogus`
          help: declare it: `<property name="...">...</property>` in the composite
        3:58-62 error S3007: property `period`: `100x` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        3:125-128 error S3004: class `example.Robot` has no property `bat`
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `passwordFile`, `tlsCa`, `tlsCertificate`, `tlsKey`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `trigger`, `minimum`, `queue` and `loss`
        4:31-37 error S2011: there is no component `Nobody`
          help: the components are `C`
          help: add a component of the class `example.Gps`
        5:99-106 error S2011: there is no component `Nowhere`
          help: add a component of the class `example.Gps`
    "#]].assert_eq(&by_condition);
}

/// The diagnostics of halls that have such a property, and attributes, when there are mistakes inside each.
fn halls(attributes: &str, property: &str) -> String {
    let inner = |number: &str, inside: &str| {
        let inside = format!("<property name=\"count\" type=\"xsd:int\" mustSupply=\"true\"/>\n{inside}");
        let namespaces = "xmlns:saoms=\"urn:saoms:1\" xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\"";
        part(number, namespaces, &inside)
    };
    let hall = "<component name=\"C${index}\" saoms:count=\"count\"><implementation.java class=\"example.Conductor\"/><property name=\"cout\">${count}</property></component>
<component name=\"D\" saoms:if=\"count &gt; 3\"><implementation.java class=\"example.Conductr\"/></component>
<component name=\"In\"><implementation.composite name=\"t:inner\"/><property name=\"count\" source=\"$count\"/></component>";
    let inside = "<component name=\"E\"><implementation.java class=\"example.Conductor${coun}\"/></component>
<component name=\"F${index}\" saoms:count=\"count\"><implementation.java class=\"example.Nobody\"/></component>";
    let around = format!(
        "<component name=\"Hall${{index}}\" saoms:count=\"2\" {attributes}><implementation.composite name=\"t:hall\"/>\n{property}</component>"
    );
    let around = part("fleet", "xmlns:saoms=\"urn:saoms:1\"", &around);
    outcome(&[&around, &inner("hall", hall), &inner("inner", inside)], &[])
}

#[test]
fn a_fault_in_what_a_component_gives_hides_nothing_inside_it() {
    let by_value = halls("", "<property name=\"count\">${indx}</property>");
    expect![[r#"
        3:26-30 error S2045: the composite has no property `indx` (in `Hall1`, index 1, and in 1 more)
          fix: replace `indx` with `index` [3:26-30 "index"]
        hall:3:18-27 error S2018: reference `gps` of component `C1` is not wired to a service (in `Hall1/C1`, index 1)
          help: give it a target with the interface `example.Positions`: `<reference name="gps" target="..."/>`
        hall:3:113-117 error S3004: class `example.Conductor` has no property `cout` (in `Hall1/C1`, index 1)
          help: `example.Conductor` has no properties at all
        hall:4:73-89 error S3001: there is no class `example.Conductr` (in `Hall1/D`)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          fix: replace `example.Conductr` with `example.Conductor` [hall:4:73-89 "example.Conductor"]
        inner:3:49-73 error S3001: there is no class `example.Conductor${coun}` (in `Hall1/In/E`)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
        inner:4:77-91 error S3001: there is no class `example.Nobody` (in `Hall1/In/F1`, index 1)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
    "#]].assert_eq(&by_value);
    let by_source = halls("", "<property name=\"count\" source=\"$n${indx}\"/>");
    expect![[r#"
        3:36-40 error S2045: the composite has no property `indx` (in `Hall1`, index 1, and in 1 more)
          fix: replace `indx` with `index` [3:36-40 "index"]
        hall:3:18-27 error S2018: reference `gps` of component `C1` is not wired to a service (in `Hall1/C1`, index 1)
          help: give it a target with the interface `example.Positions`: `<reference name="gps" target="..."/>`
        hall:3:113-117 error S3004: class `example.Conductor` has no property `cout` (in `Hall1/C1`, index 1)
          help: `example.Conductor` has no properties at all
        hall:4:73-89 error S3001: there is no class `example.Conductr` (in `Hall1/D`)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          fix: replace `example.Conductr` with `example.Conductor` [hall:4:73-89 "example.Conductor"]
        inner:3:49-73 error S3001: there is no class `example.Conductor${coun}` (in `Hall1/In/E`)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
        inner:4:77-91 error S3001: there is no class `example.Nobody` (in `Hall1/In/F1`, index 1)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
    "#]].assert_eq(&by_source);
    let by_name = halls("", "<property name=\"coun${indx}\">1</property>");
    expect![[r#"
        3:23-27 error S2045: the composite has no property `indx` (in `Hall1`, index 1, and in 1 more)
          fix: replace `indx` with `index` [3:23-27 "index"]
        hall:3:18-27 error S2018: reference `gps` of component `C1` is not wired to a service (in `Hall1/C1`, index 1)
          help: give it a target with the interface `example.Positions`: `<reference name="gps" target="..."/>`
        hall:3:113-117 error S3004: class `example.Conductor` has no property `cout` (in `Hall1/C1`, index 1)
          help: `example.Conductor` has no properties at all
        hall:4:73-89 error S3001: there is no class `example.Conductr` (in `Hall1/D`)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          fix: replace `example.Conductr` with `example.Conductor` [hall:4:73-89 "example.Conductor"]
        inner:3:49-73 error S3001: there is no class `example.Conductor${coun}` (in `Hall1/In/E`)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
        inner:4:77-91 error S3001: there is no class `example.Nobody` (in `Hall1/In/F1`, index 1)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
    "#]].assert_eq(&by_name);
    let by_table = halls("saoms:overrides=\"none.csv\"", "");
    expect![[r#"
        2:65-73 error S0003: the file was not read
        hall:3:18-27 error S2018: reference `gps` of component `C1` is not wired to a service (in `Hall1/C1`, index 1)
          help: give it a target with the interface `example.Positions`: `<reference name="gps" target="..."/>`
        hall:3:113-117 error S3004: class `example.Conductor` has no property `cout` (in `Hall1/C1`, index 1)
          help: `example.Conductor` has no properties at all
        hall:4:73-89 error S3001: there is no class `example.Conductr` (in `Hall1/D`)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          fix: replace `example.Conductr` with `example.Conductor` [hall:4:73-89 "example.Conductor"]
        inner:3:49-73 error S3001: there is no class `example.Conductor${coun}` (in `Hall1/In/E`)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
        inner:4:77-91 error S3001: there is no class `example.Nobody` (in `Hall1/In/F1`, index 1)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
    "#]].assert_eq(&by_table);
}

/// A board with these properties, and three marks: one beside any board, one beside one of the usual size, and one is
/// none.
fn board(properties: &str) -> String {
    of(&format!(
        "<component name=\"B\"><implementation.java class=\"example.Board\"/><property name=\"ID\">B</property>
<property name=\"marks\"><value>300,1</value><value>1,20</value><value>x</value></property><property name=\"label\">dark</property>
{properties}</component>"
    ))
}

#[test]
fn a_wrong_value_hides_nothing_that_the_constructor_finds_in_others() {
    expect![[r#"
        3:31-36 error S3014: component `B`: property `marks`: `300,1` is beside the board
          help: `saoms components example.Board` describes its properties
        3:51-55 error S3014: component `B`: property `marks`: `1,20` is beside the board
          help: `saoms components example.Board` describes its properties
        3:70-71 error S3014: component `B`: property `marks`: `x` is no mark
          help: `saoms components example.Board` describes its properties
        3:113-117 error S3014: component `B`: property `label`: it is too dark
          help: `saoms components example.Board` describes its properties
        4:25-29 error S3007: property `period`: `10Hz` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
          fix: replace `10Hz` with `100ms` [4:25-29 "100ms"]
    "#]].assert_eq(&board("<property name=\"period\">10Hz</property>"));
    expect![[r#"
        3:31-36 error S3014: component `B`: property `marks`: `300,1` is beside the board
          help: `saoms components example.Board` describes its properties
        3:70-71 error S3014: component `B`: property `marks`: `x` is no mark
          help: `saoms components example.Board` describes its properties
        3:113-117 error S3014: component `B`: property `label`: it is too dark
          help: `saoms components example.Board` describes its properties
        4:53-59 error S3004: class `example.Board` has no property `heigth`
          fix: replace `heigth` with `height` [4:53-59 "height"]
        4:90-96 error S3004: class `example.Board` has no property `heigth`
          fix: replace `heigth` with `height` [4:90-96 "height"]
    "#]].assert_eq(&board(
        "<property name=\"period\">1</property><property name=\"heigth\">30</property><property name=\"heigth\">30</property>",
    ));
    expect![[r#"
        3:31-36 error S3014: component `B`: property `marks`: `300,1` is beside the board
          help: `saoms components example.Board` describes its properties
        3:51-55 error S3014: component `B`: property `marks`: `1,20` is beside the board
          help: `saoms components example.Board` describes its properties
        3:70-71 error S3014: component `B`: property `marks`: `x` is no mark
          help: `saoms components example.Board` describes its properties
        3:113-117 error S3014: component `B`: property `label`: it is too dark
          help: `saoms components example.Board` describes its properties
        4:60-62 error S3007: property `width`: `3O` is not a whole number: expected a whole number from 1 to 100
          help: the default is `8`
    "#]]
    .assert_eq(&board("<property name=\"period\">1</property><property name=\"width\">3O</property>"));
    // A label may say anything.
    expect![[r#"
        4:53-58 error S3005: the property `label` is given twice
          3:106-111 first given here
          help: keep one of them
    "#]]
    .assert_eq(&board("<property name=\"period\">1</property><property name=\"label\" value=\"bright\"/>"));
}

#[test]
fn a_file_that_is_given_twice_is_told_once() {
    let text = fleet(
        "<component name=\"G\"><implementation.java class=\"example.Gps\"/></component>\n<component name=\"R\"><implementation.java class=\"example.Robott\"/></component>",
    );
    expect![[r#"
        3:49-63 error S3001: there is no class `example.Robott`
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          fix: replace `example.Robott` with `example.Robot` [3:49-63 "example.Robot"]
        more.composite:1:99-104 error S2001: there are two composites `fleet` in one namespace
          1:99-104 the first
          help: give each its own name; was one file given twice?
    "#]].assert_eq(&faults_of(&[&text, &text], &[]));
    // Another file of the same name is looked at.
    let other = text.replace("\"G\"", "\"H\"");
    expect![[r#"
        3:49-63 error S3001: there is no class `example.Robott`
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          fix: replace `example.Robott` with `example.Robot` [3:49-63 "example.Robot"]
        more.composite:1:99-104 error S2001: there are two composites `fleet` in one namespace
          1:99-104 the first
          help: give each its own name; was one file given twice?
        more.composite:3:18-19 error S2002: there are two components `R`
          3:18-19 the first
          help: files given together form one fleet: for two fleets, run the command once for each file
          fix: remove the second: both are the same, word for word [more.composite:3:1-78 ""]
        more.composite:3:49-63 error S3001: there is no class `example.Robott`
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          fix: replace `example.Robott` with `example.Robot` [more.composite:3:49-63 "example.Robot"]
    "#]].assert_eq(&faults_of(&[&text, &other], &[]));
}

#[test]
fn too_many_targets_of_a_reference_around_another_are_told_where_they_are() {
    let frame = part(
        "frame",
        "",
        "<reference name=\"pos\" promote=\"R/gps\"/>
<component name=\"R\"><implementation.java class=\"example.Robot\"/><property name=\"ID\">R</property><property name=\"period\">1</property><property name=\"number\">1</property></component>",
    );
    let inside = "<component name=\"U\"><implementation.composite name=\"t:frame\"/><reference name=\"pos\" target=\"A B\"/></component>
<component name=\"A\"><implementation.java class=\"example.Gps\"/></component><component name=\"B\"><implementation.java class=\"example.Gps\"/></component>";
    expect![[r#"
        2:95-96 error S2017: reference `pos` of component `U` allows one target, found 2
          2:93-94 the first
          help: keep one of them
    "#]]
    .assert_eq(&outcome(&[&part("fleet", "", inside), &frame], &[]));
}

#[test]
fn a_list_of_topics_that_components_share_is_told_what_nobody_uses() {
    let inside = |list: &str| {
        let one = |name: &str, class: &str| {
            format!(
                "<component name=\"{name}\"><implementation.java class=\"example.{class}\"/><property name=\"ID\">{name}</property><property name=\"period\">1</property>{list}</component>\n"
            )
        };
        format!(
            "<property name=\"topics\">TRACKS,a::ORDERS,b::ORDRS,c</property>\n{}{}{}",
            one("T", "Tracker"),
            one("D", "Dispatcher"),
            one("E", "Dispatcher")
        )
    };
    expect![[r#"
        2:45-50 warning S4003: none of the 2 classes that share this uses a topic `ORDRS`: nothing is renamed
          help: remove the pair: all topics there have new names already"#]]
    .assert_eq(
        &of(&inside("<property name=\"topicRename\" source=\"$topics\"/>"))
            .lines()
            .filter(|line| !line.contains("example."))
            .collect::<Vec<_>>()
            .join("\n"),
    );
    let own = inside("<property name=\"topicRename\">TRACKS,a::ORDERS,b</property>")
        .replace("TRACKS,a::ORDERS,b::ORDRS,c", "x");
    expect![[r#"
        2:17-23 warning S2026: no component uses the property `topics` of the composite
          help: remove it, or use its value in a component with `source="$topics"`
        3:174-180 warning S4003: class `example.Tracker` uses no topic `ORDERS`: nothing is renamed
          help: remove the pair: all topics there have new names already
        4:167-173 warning S4003: class `example.Dispatcher` uses no topic `TRACKS`: nothing is renamed
          help: remove the pair: all topics there have new names already
        5:167-173 warning S4003: class `example.Dispatcher` uses no topic `TRACKS`: nothing is renamed
          help: remove the pair: all topics there have new names already"#]]
    .assert_eq(&of(&own).lines().filter(|line| !line.contains(" (example.")).collect::<Vec<_>>().join("\n"));
}

#[test]
fn slips_that_many_make_have_hints() {
    let robot = |properties: &str| {
        format!(
            "<property name=\"tick\">5</property><component name=\"R\"><implementation.java class=\"example.Robot\"/><property name=\"ID\">R</property>{properties}</component>"
        )
    };
    let found = |period: &str, number: &str| {
        let number = format!("<property name=\"number\">{number}</property>");
        let all = of(&robot(&format!("<property name=\"period\">{period}</property>{number}")));
        let hints = all
            .lines()
            .filter(|line| line.contains("fix:") || line.contains("source=") || line.contains("saoms:count"));
        hints.map(|line| line.trim().to_owned() + "\n").collect::<String>()
    };
    let all =
        ["10Hz", "3hz", "2 sec", "5 minutes", "$tick", "$(arg tick)", "${100 + index}", "0.5.1 sec", "0Hz", "$ x"];
    let all: Vec<String> = all.iter().map(|period| format!("{period} => {}", found(period, "1"))).collect();
    expect![[r#"
        10Hz => help: remove it, or use its value in a component with `source="$tick"`
        fix: replace `10Hz` with `100ms` [2:155-159 "100ms"]

        3hz => help: remove it, or use its value in a component with `source="$tick"`
        fix: replace `3hz` with `333333us` [2:155-158 "333333us"]

        2 sec => help: remove it, or use its value in a component with `source="$tick"`
        fix: replace `2 sec` with `2s` [2:155-160 "2s"]

        5 minutes => help: remove it, or use its value in a component with `source="$tick"`
        fix: replace `5 minutes` with `5min` [2:155-164 "5min"]

        $tick => help: write `source="$tick"` for the value of the property `tick` of the composite

        $(arg tick) => help: remove it, or use its value in a component with `source="$tick"`
        help: write `source="$tick"` for the value of the property `tick` of the composite

        ${100 + index} => help: `${...}` is evaluated only in components with a `saoms:count`

        0.5.1 sec => help: remove it, or use its value in a component with `source="$tick"`

        0Hz => help: remove it, or use its value in a component with `source="$tick"`

        $ x => help: remove it, or use its value in a component with `source="$tick"`
        help: write `source="$x"` for the value of the property `x` of the composite
    "#]]
    .assert_eq(&all.join("\n"));
    expect![[r#"
        4:15-25 error S2016: this wire is reversed: `A/position` offers a service, and `N/wheels` is a reference
          fix: swap `source` and `target` [4:15-25 "N/wheels"] [4:35-43 "A/position"]
        4:17-25 error S2015: service `position` of component `A` has the interface `example.Positions`, and the reference needs `example.Wheels`
          help: it offers `position` (example.Positions)
        5:42-46 error S2045: write the expression here without `${` and `}`
          fix: replace `${3}` with `3` [5:42-46 "3"]
        6:22-43 error S1004: SCA 1.1 has no element `implementation.prolog`
          help: if it is an extension, write it with a prefix of its own namespace
          help: `implementation.rust`, `implementation.java` and `implementation.python` name a class, `implementation.composite` a composite
        7:22-40 error S1004: SCA 1.1 has no element `implementation.jva`
          fix: replace `implementation.jva` with `implementation.java` [7:22-40 "implementation.java"]
        8:53-65 error S2031: there is no composite `in.composite` in the namespace `urn:t`
          help: write the composite's `name` with the prefix of its `targetNamespace`, not the name of its file
          help: name the file of that composite in the command as well
    "#]].assert_eq(&of(
        "<component name=\"A\"><implementation.java class=\"example.Gps\"/></component>
<component name=\"N\"><implementation.java class=\"example.Navigator\"/></component>
<wire source=\"A/position\" target=\"N/wheels\"/>
<component name=\"B${index}\" saoms:count=\"${3}\"><implementation.java class=\"example.Gps\"/></component>
<component name=\"P\"><implementation.prolog class=\"example.Gps\"/></component>
<component name=\"J\"><implementation.jva class=\"example.Gps\"/></component>
<component name=\"I\"><implementation.composite name=\"in.composite\"/></component>",
    ));
}

#[test]
fn a_damaged_component_hides_unknown_ones_only_where_its_name_is_unreadable() {
    let with_tag = |damaged: &str| {
        of(&format!(
            "{damaged}<implementation.java class=\"example.Gps\"/></component>
<component name=\"C\"><implementation.java class=\"example.Conductor\"/><reference name=\"gps\" target=\"Nowhere\"/></component>"
        ))
    };
    // The name is there, whatever else is wrong with the component.
    expect![[r#"
        2:22-28 error S1004: SCA 1.1 has no element `servce`
          fix: replace `servce` with `service` [2:22-28 "service"]
        2:34-35 error S0105: the value of `name` is not in quotes
          fix: put it in quotes [2:34-35 "\"x\""]
        2:34-35 error S2005: class `example.Gps` has no service `x`
          help: its services are `position`
        3:99-106 error S2011: there is no component `Nowhere`
          help: the components are `G`
    "#]]
    .assert_eq(&with_tag("<component name=\"G\"><servce name=x/>"));
    expect![[r#"
        2:21-24 error S0112: the prefix `odd` is not declared
          help: declare it, as `xmlns:odd="..."`, in this element or in one around it
        3:99-106 error S2011: there is no component `Nowhere`
          help: the components are `G`
    "#]]
    .assert_eq(&with_tag("<component name=\"G\" odd:is=\"x\">"));
    // It may be the one that is meant.
    expect![[r#"
        2:22-23 error S0105: white space is missing between two attributes
          fix: insert a blank [2:22-22 " "]
    "#]]
    .assert_eq(&with_tag("<component name=\"Now\"here\">"));
    expect![[r#"
        2:21-25 error S0106: the attribute `name` is given twice
          2:12-16 first given here
          fix: remove the second `name` [2:20-35 ""]
    "#]]
    .assert_eq(&with_tag("<component name=\"G\" name=\"Nowhere\">"));
    expect![[r#"
        2:12-16 error S0105: the attribute `name` has no value
          help: write `name="..."`
    "#]]
    .assert_eq(&with_tag("<component name>"));
}

#[test]
fn a_misspelt_property_is_told_although_its_component_has_no_end_tag() {
    let open =
        r#"<component name="A"><implementation.java class="example.Robot001"/><property name="spede">2</property>"#;
    let other = r#"<component name="B"><implementation.java class="example.Robot001"/></component>"#;
    let found = faults_of(&[&fleet(&format!("{open}\n{other}"))], &[]);
    assert!(found.contains("error S0103") && found.contains("has no property `spede`"), "{found}");
    assert!(found.contains("replace `spede` with `speed`"), "{found}");
}
