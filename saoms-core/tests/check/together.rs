//! Mistakes are told together: one hides no other, and each is told once.

use expect_test::expect;

use crate::support::{outcome, part};

/// What is wrong with a fleet with the prefix of SAOMS.
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
        3:24-28 error S2045: the composite has no property `inde` (in `R1`, index 1)
          help: declare it: `<property name="...">...</property>` in the composite
          fix: replace `inde` with `index` [3:24-28 "index"]
        3:64-68 error S3007: property `period`: `100x` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h) (in `R1`, index 1)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        3:131-134 error S3004: class `example.Robot` has no property `bat` (in `R1`, index 1)
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `queue` and `loss`
        4:31-37 error S2011: there is no component `Nobody` (in `R1`, index 1)
          help: the components are `C` and `R*`
        5:99-106 error S2011: there is no component `Nowhere`
          help: the components are `C` and `R*`
    "#]].assert_eq(&by_id);
    let by_count = of(&robot("name=\"R${index}\" saoms:count=\"k\"", "R${index}"));
    expect![[r#"
        2:42-43 error S2045: the composite has no property `k`
          help: declare it: `<property name="...">...</property>` in the composite
        3:65-69 error S3007: property `period`: `100x` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h) (in `R1`, index 1)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        3:132-135 error S3004: class `example.Robot` has no property `bat` (in `R1`, index 1)
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `queue` and `loss`
        4:31-37 error S2011: there is no component `Nobody` (in `R1`, index 1)
          help: the components are `C` and `R*`
        5:99-106 error S2011: there is no component `Nowhere`
          help: the components are `C` and `R*`
    "#]].assert_eq(&by_count);
    let by_table =
        of(&robot("name=\"R${index}\" saoms:count=\"3\" saoms:overrides=\"none.csv\"", "R${index}"));
    expect![[r#"
        2:62-70 error S0003: the file was not read
        3:65-69 error S3007: property `period`: `100x` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h) (in `R1`, index 1)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        3:132-135 error S3004: class `example.Robot` has no property `bat` (in `R1`, index 1)
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `queue` and `loss`
        4:31-37 error S2011: there is no component `Nobody` (in `R1`, index 1)
          help: the components are `C` and `R*`
        5:99-106 error S2011: there is no component `Nowhere`
          help: the components are `C` and `R*`
    "#]].assert_eq(&by_table);
    let by_name = of(&robot("name=\"R${inde}\" saoms:count=\"3\"", "R${index}"));
    expect![[r#"
        2:21-25 error S2045: the composite has no property `inde` (in `R${inde}`, index 1)
          help: declare it: `<property name="...">...</property>` in the composite
          fix: replace `inde` with `index` [2:21-25 "index"]
        3:65-69 error S3007: property `period`: `100x` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h) (in `R${inde}`, index 1)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        3:132-135 error S3004: class `example.Robot` has no property `bat` (in `R${inde}`, index 1)
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `queue` and `loss`
        4:31-37 error S2011: there is no component `Nobody` (in `R${inde}`, index 1)
          help: the components are `C` and `R*`
        5:99-106 error S2011: there is no component `Nowhere`
          help: the components are `C` and `R*`
    "#]].assert_eq(&by_name);
    let by_condition = of(&robot("name=\"R2\" saoms:if=\"bogus\"", "R2"));
    expect![[r#"
        2:32-37 error S2045: the composite has no property `bogus`
          help: declare it: `<property name="...">...</property>` in the composite
        3:58-62 error S3007: property `period`: `100x` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        3:125-128 error S3004: class `example.Robot` has no property `bat`
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `queue` and `loss`
        4:31-37 error S2011: there is no component `Nobody`
          help: the components are `C`
        5:99-106 error S2011: there is no component `Nowhere`
          help: the components are `C`
    "#]].assert_eq(&by_condition);
}

/// A board with these properties, and marks of which one is beside any board, one beside one of the usual size, and one is none.
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
          help: `saoms components example.Board` says what its properties mean
        3:51-55 error S3014: component `B`: property `marks`: `1,20` is beside the board
          help: `saoms components example.Board` says what its properties mean
        3:70-71 error S3014: component `B`: property `marks`: `x` is no mark
          help: `saoms components example.Board` says what its properties mean
        3:113-117 error S3014: component `B`: property `label`: it is too dark
          help: `saoms components example.Board` says what its properties mean
        4:25-29 error S3007: property `period`: `10Hz` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
    "#]].assert_eq(&board("<property name=\"period\">10Hz</property>"));
    expect![[r#"
        3:31-36 error S3014: component `B`: property `marks`: `300,1` is beside the board
          help: `saoms components example.Board` says what its properties mean
        3:70-71 error S3014: component `B`: property `marks`: `x` is no mark
          help: `saoms components example.Board` says what its properties mean
        3:113-117 error S3014: component `B`: property `label`: it is too dark
          help: `saoms components example.Board` says what its properties mean
        4:53-59 error S3004: class `example.Board` has no property `heigth`
          fix: replace `heigth` with `height` [4:53-59 "height"]
        4:90-96 error S3004: class `example.Board` has no property `heigth`
          fix: replace `heigth` with `height` [4:90-96 "height"]
    "#]].assert_eq(&board(
        "<property name=\"period\">1</property><property name=\"heigth\">30</property><property name=\"heigth\">30</property>",
    ));
    expect![[r#"
        3:31-36 error S3014: component `B`: property `marks`: `300,1` is beside the board
          help: `saoms components example.Board` says what its properties mean
        3:51-55 error S3014: component `B`: property `marks`: `1,20` is beside the board
          help: `saoms components example.Board` says what its properties mean
        3:70-71 error S3014: component `B`: property `marks`: `x` is no mark
          help: `saoms components example.Board` says what its properties mean
        3:113-117 error S3014: component `B`: property `label`: it is too dark
          help: `saoms components example.Board` says what its properties mean
        4:60-62 error S3007: property `width`: `3O` is not a whole number: expected a whole number from 1 to 100
          help: the default is `8`
    "#]]
        .assert_eq(&board("<property name=\"period\">1</property><property name=\"width\">3O</property>"));
    // A label may say anything.
    expect![[r#"
        4:53-58 error S3005: the property `label` is given twice
          3:106-111 first here
          help: keep one of them
    "#]]
    .assert_eq(&board("<property name=\"period\">1</property><property name=\"label\" value=\"bright\"/>"));
}
