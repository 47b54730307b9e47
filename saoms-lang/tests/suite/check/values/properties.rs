//! Classes and properties.

use expect_test::expect;

use crate::check::support::{faults, faults_of, fleet, fleet_1_0};

/// A robot with this inside its `<component>`, besides its class and what it has to have.
pub(crate) fn robot(inside: &str) -> String {
    format!(
        r#"<component name="R"><implementation.java class="example.Robot001"/><property name="ID">R</property><property name="period">100</property>
{inside}
</component>"#
    )
}

#[test]
fn a_right_composite_has_no_faults() {
    expect![""].assert_eq(&faults(&robot(
        r#"<property name="number">7</property>
        <property name="speed" value="2.0"/>
        <property name="colour">red</property>
        <property name="awake">0</property>
        <property name="charger"><x xmlns="">3</x><y xmlns="">4</y></property>
        <property name="stops"><value>1</value><value>2</value></property>
        <property name="grace">1.5 s</property>
        <property name="delay">0</property>"#,
    )));
}

#[test]
fn a_wrong_source_is_one_fault() {
    let found = faults(
        r#"<property name="period">100</property>
<component name="R"><implementation.java class="example.Robot001"/><property name="ID">R</property><property name="period" source="$perid"/></component>"#,
    );
    assert_eq!(found.matches("error").count(), 1, "{found}");
    assert!(found.contains("error S2024: the composite has no property `perid`"), "{found}");
}

#[test]
fn a_component_without_a_name_is_not_called_by_an_empty_one() {
    let found = faults(r#"<component><implementation.java class="example.Robot001"/></component>"#);
    assert!(found.contains("the component needs the property `period`"), "{found}");
}

#[test]
fn unknown_classes_are_offered_the_nearest() {
    expect![[r#"
        2:49-64 error S3001: there is no class `example.Robt001`
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          fix: replace `example.Robt001` with `example.Robot001` [2:49-64 "example.Robot001"]
        3:49-70 error S3001: there is no class `org.example.navigator`
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          fix: replace `org.example.navigator` with `example.Navigator` [3:49-70 "example.Navigator"]
        4:49-66 error S3001: there is no class `com.example.Wheel`
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
    "#]]
    .assert_eq(&faults(
        r#"<component name="A"><implementation.java class="example.Robt001"/></component>
<component name="B"><implementation.rust class="org.example.navigator"/></component>
<component name="C"><implementation.java class="com.example.Wheel"/></component>"#,
    ));
}

#[test]
fn what_cannot_run_says_so() {
    expect![[r#"
        2:53-58 error S2031: there is no composite `inner` in the namespace `urn:t`
          help: name the file of that composite in the command as well
        3:22-41 error S3002: this program cannot run `implementation.bpel`
          help: name the class of the component: `implementation.java class="..."`, `implementation.rust class="..."` or `implementation.python module="..." class="..."`
        4:71-80 error S3015: the library `libgps.so` was not searched for
        5:16-21 error S2030: there is no composite `other` in the namespace `urn:t`
          help: name the file of that composite in the command as well
        6:22-45 error S3002: this program cannot run `implementation.script`
          help: name the class of the component: `implementation.java class="..."`, `implementation.rust class="..."` or `implementation.python module="..." class="..."`
    "#]]
    .assert_eq(&faults(
        r#"<component name="A"><implementation.composite name="inner"/></component>
<component name="B"><implementation.bpel process="p"/></component>
<component name="C"><implementation.rust class="example.Gps" library="libgps.so"/></component>
<include name="other"/>
<component name="D"><x:implementation.script xmlns:x="urn:x" script="a.rb"/></component>"#,
    ));
    expect![[r#"
        2:2-11 error S1010: the component `A` has no implementation
          help: write `<implementation.java class="..."/>` or `<implementation.rust class="..."/>` in it
          help: SCA 1.0 allows a component without an implementation, but it cannot run
    "#]]
    .assert_eq(&faults_of(&[&fleet_1_0(r#"<component name="A"/>"#)], &[]));
    expect![[r#"
        2:2-11 error S1010: the component `A` has no implementation
          help: write `<implementation.java class="..."/>` or `<implementation.rust class="..."/>` in it
    "#]]
    .assert_eq(&faults_of(&[&fleet(r#"<component name="A"/>"#)], &[]));
}

#[test]
fn unknown_and_repeated_properties() {
    expect![[r#"
        3:17-21 error S3004: class `example.Robot001` has no property `sped`
          help: `speed` is given already: remove one of the two
        5:17-22 error S3005: the property `speed` is given twice
          4:17-22 first given here
          help: keep one of them
        6:17-23 error S3004: class `example.Robot001` has no property `weight`
          help: its properties are `ID`, `number`, `speed`, `colour`, `awake`, `charger`, `stops`, `grace`, `period`, `delay`, `runOnStartup`, `mayInterruptIfRunning`, `useJMS`, `url`, `user`, `password`, `passwordFile`, `tlsCa`, `tlsCertificate`, `tlsKey`, `topicRename`, `overrun`, `restart`, `restartBackoff`, `restartLimit`, `deadline`, `trigger`, `minimum`, `queue` and `loss`
        7:17-20 error S3004: class `example.Robot001` has no property `URL`
          fix: replace `URL` with `url` [7:17-20 "url"]
    "#]].assert_eq(&faults(&robot(
        r#"<property name="sped">1</property>
<property name="speed">1</property>
<property name="speed">2</property>
<property name="weight">2</property>
<property name="URL">localhost:61616</property>"#,
    )));
    expect![[r#"
        3:17-23 error S3004: class `example.Navigator` has no property `period`
          help: `example.Navigator` is passive: it is never executed and has no task properties
        7:17-23 error S3004: class `example.Broker` has no property `period`
          help: `example.Broker` is passive: it is never executed and has no task properties
    "#]].assert_eq(&faults(
        r#"<component name="N"><implementation.java class="example.Navigator"/>
<property name="period">100</property>
<reference name="wheels" target="R"/></component>
<component name="R"><implementation.java class="example.Robot001"/><property name="ID">R</property><property name="period">1</property></component>
<component name="B"><implementation.java class="example.Broker"/><property name="IP">a</property><property name="port">1</property>
<property name="period">1</property></component>"#,
    ));
}

#[test]
fn missing_properties_stand_at_the_name_of_the_component() {
    expect![[r#"
        2:18-19 error S3006: component `R` needs the property `ID`
          help: add `<property name="ID">...</property>`: a text that is not empty
        2:18-19 error S3006: component `R` needs the property `number`
          help: add `<property name="number">...</property>`: a whole number from 1 to 99
        2:18-19 error S3006: component `R` needs the property `period`
          help: add `<property name="period">...</property>`: a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
        4:17-19 error S3004: class `example.Robot` has no property `Id`
          fix: replace `Id` with `ID` [4:17-19 "ID"]
        4:49-55 error S3004: class `example.Robot` has no property `peroid`
          fix: replace `peroid` with `period` [4:49-55 "period"]
    "#]].assert_eq(&faults(
        r#"<component name="R"><implementation.java class="example.Robot"/></component>
<component name="S"><implementation.java class="example.Robot"/>
<property name="Id">S</property><property name="peroid">100</property><property name="number">5</property></component>"#,
    ));
    expect![[r#"
        2:20-21 error S3006: component `C` needs the property `period`
          help: add `<s:property name="period">...</s:property>`: a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
    "#]].assert_eq(&faults_of(
        &[r#"<s:composite xmlns:s="http://www.osoa.org/xmlns/sca/1.0" targetNamespace="urn:t" name="fleet">
<s:component name="C"><s:implementation.java class="example.Clock"/><s:property name="ID">C</s:property></s:component>
</s:composite>"#],
        &[],
    ));
}

#[test]
fn values_of_the_wrong_type() {
    expect![[r#"
        3:25-30 error S3007: property `number`: `seven` is not a whole number: expected a whole number from 1 to 99
          help: `number`: The number of the robot
        4:24-27 error S3007: property `speed`: `1,5` is not a number: expected a number from 0.0 to 2.5 [m/s]
          help: `speed`: How fast it drives; the default is `1.0`
          fix: replace `1,5` with `1.5` [4:24-27 "1.5"]
        5:24-27 error S3007: property `awake`: `yes` is not a boolean: expected `true` or `false`
          help: the default is `true`
          fix: replace `yes` with `true` [5:24-27 "true"]
        6:25-29 error S3009: property `colour`: `bleu` is not allowed: expected `red` or `blue`
          help: the default is `blue`
          fix: replace `bleu` with `blue` [6:25-29 "blue"]
        7:24-28 error S3007: property `grace`: `soon` is not a duration: expected a duration (in ms, or with a unit: ns, us, ms, s, min, h)
          help: the default is `10ms`
        8:26-27 error S3007: property `charger`: found `5`, expected the properties x, y
          help: write each of them as an element inside
          help: `charger`: Where it charges
        9:47-48 error S3011: the property `delay` allows one value, found 2
          9:31-32 the first
          help: `delay`: From the start to the first due execution; the default is `0ms`
        10:47-48 error S3007: property `stops`: `x` is not a whole number: expected a whole number from 0 to 65535
        10:63-68 error S3008: property `stops`: `70000` is out of range: expected a whole number from 0 to 65535
        11:31-35 error S3007: property `runOnStartup`: `True` is not a boolean: expected `true` or `false`
          help: `runOnStartup`: Whether the task is scheduled when the fleet starts, or waits for a call of its TaskInterface; the default is `true`
          fix: replace `True` with `true` [11:31-35 "true"]
    "#]].assert_eq(&faults(&robot(
        r#"<property name="number">seven</property>
<property name="speed">1,5</property>
<property name="awake">yes</property>
<property name="colour">bleu</property>
<property name="grace">soon</property>
<property name="charger">5</property>
<property name="delay"><value>1</value><value>2</value></property>
<property name="stops"><value>1</value><value>x</value><value>70000</value></property>
<property name="runOnStartup">True</property>"#,
    )));
}

#[test]
fn values_out_of_range_or_not_allowed() {
    expect![[r#"
        3:25-28 error S3008: property `number`: `100` is out of range: expected a whole number from 1 to 99
          help: `number`: The number of the robot
        4:24-29 error S3007: property `speed`: `3 m/s` is not a number: expected a number from 0.0 to 2.5 [m/s]
          help: `speed`: How fast it drives; the default is `1.0`
        5:25-30 error S3009: property `colour`: `green` is not allowed: expected `red` or `blue`
          help: the default is `blue`
        6:26-33 error S3009: property `overrun`: `catchup` is not allowed: expected `skip`, `catchUp` or `stop`
          help: `overrun`: What happens to executions that could not start before the next one was due; the default is `skip`
          fix: replace `catchup` with `catchUp` [6:26-33 "catchUp"]
        7:26-32 error S3009: property `restart`: `always` is not allowed: expected `never` or `onFailure`
          help: `restart`: What happens after a failure; the default is `never`
        8:31-32 error S3008: property `restartLimit`: `0` is out of range: expected a whole number from 1 to 1000000
          help: `restartLimit`: How many restarts there may be in a run; the default is `5`
        9:24-65 error S3008: property `queue`: `99999999999999999999999999999999999999999` is out of range: expected a whole number from 1 to 1000000 [messages]
          help: `queue`: How many messages may wait in each queue of an event topic. By default 1024, or 16 for each component that uses the topic, if that is more
        10:23-27 error S3009: property `loss`: `true` is not allowed: expected `fail` or `accept`
          help: `loss`: What an overflow of such a queue means for the run; the default is `fail`
    "#]].assert_eq(&faults(&robot(
        r#"<property name="number">100</property>
<property name="speed">3 m/s</property>
<property name="colour">green</property>
<property name="overrun">catchup</property>
<property name="restart">always</property>
<property name="restartLimit">0</property>
<property name="queue">99999999999999999999999999999999999999999</property>
<property name="loss">true</property>"#,
    )));
}

#[test]
fn absurd_periods() {
    let period = |text: &str| {
        faults(&format!(
            r#"<component name="C"><implementation.java class="example.Clock"/><property name="ID">C</property><property name="period">{text}</property></component>"#
        ))
    };
    let all: String = [
        "0", "-5", "-1s", "99us", "25h", "1e3", "100 ms", "100us", "24h", "10 min", "inf", "1 week",
        "184467440737095516150000s",
    ]
    .map(|text| format!("{text}\n{}", period(text)))
    .concat();
    expect![[r#"
        0
        2:121-122 error S3008: property `period`: `0` is out of range: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        -5
        2:121-123 error S3008: property `period`: `-5` is negative: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        -1s
        2:121-124 error S3008: property `period`: `-1s` is negative: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        99us
        2:121-125 error S3008: property `period`: `99us` is out of range: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        25h
        2:121-124 error S3008: property `period`: `25h` is out of range: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        1e3
        2:121-124 error S3007: property `period`: `1e3` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
          fix: replace `1e3` with `1000` [2:121-124 "1000"]
        100 ms
        100us
        24h
        10 min
        inf
        2:121-124 error S3007: property `period`: `inf` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        1 week
        2:121-127 error S3007: property `period`: `1 week` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        184467440737095516150000s
        2:121-146 error S3008: property `period`: `184467440737095516150000s` is out of range: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
    "#]].assert_eq(&all);
}

#[test]
fn empty_values() {
    expect![[r#"
        3:2-10 error S3010: property `ID`: the value is empty: expected a text that is not empty
          help: `ID`: The robot's name
        4:2-10 error S3010: property `period`: the value is empty: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
        5:31-31 error S3010: property `speed`: the value is empty: expected a number from 0.0 to 2.5 [m/s]
          help: `speed`: How fast it drives; the default is `1.0`
        6:32-32 error S3010: property `delay`: the value is empty: expected a duration from 0ms to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `delay`: From the start to the first due execution; the default is `0ms`
        7:2-10 error S3006: the property `charger.x` is missing: expected a whole number from -2147483648 to 2147483647
    "#]].assert_eq(&faults(
        r#"<component name="R"><implementation.java class="example.Robot001"/>
<property name="ID"> </property>
<property name="period"/>
<property name="speed" value=""/>
<property name="delay"><value/></property>
<property name="charger"/>
<property name="topicRename"></property>
<property name="url"></property>
<property name="user"/>
</component>"#,
    ));
}

#[test]
fn values_in_two_ways_and_complex_ones() {
    expect![[r#"
        3:34-35 error S3012: the property `speed` is given a value in two ways
          3:31-32 the other value
          help: write it in one way: as text inside, as the attribute `value`, as `<value>` elements, or in a `file`
        4:42-43 error S3012: the property `number` is given a value in two ways
          4:26-31 the other value
          help: write it in one way: as text inside, as the attribute `value`, as `<value>` elements, or in a `file`
        5:25-26 error S3007: the property `grace` has elements inside: expected a duration (in ms, or with a unit: ns, us, ms, s, min, h)
          help: the default is `10ms`
        6:38-39 error S3007: property `charger.x`: `a` is not a whole number: expected a whole number from -2147483648 to 2147483647
        6:55-57 error S3008: property `charger.y`: `11` is out of range: expected a whole number from 0 to 10
          help: the default is `0`
        6:62-63 error S3005: the property `charger` has two parts `y`
          6:44-45 the first
          help: `charger`: Where it charges
        6:79-80 error S3004: the property `charger` has no part `z`
          help: its parts are `x` and `y`
          help: `charger`: Where it charges
    "#]].assert_eq(&faults(&robot(
        r#"<property name="speed" value="1">2</property>
<property name="number"><value>1</value><x xmlns="urn:x">1</x></property>
<property name="grace"><x xmlns="urn:x">1</x></property>
<property name="charger"><x xmlns="">a</x><y xmlns="">11</y><y xmlns="">1</y><z xmlns="">1</z></property>"#,
    )));
    expect![[r#"
        3:2-10 error S3006: the property `charger.x` is missing: expected a whole number from -2147483648 to 2147483647
    "#]]
    .assert_eq(&faults(&robot(r#"<property name="charger"><y xmlns="">1</y></property>"#)));
}

#[test]
fn unique_values_and_shared_ids() {
    expect![[r#"
        3:85-86 error S3013: components `A` and `B` have the same `ID` `R`
          2:88-89 the first
          help: give every robot its own `ID`
        5:85-89 warning S4001: components `C` and `D` share the ID `MEMS`
          4:85-89 the first
          help: give each its own ID: messages and reports name tasks by their ID
        6:85-86 warning S4001: components `A` and `E` share the ID `R`
          2:88-89 the first
          help: give each its own ID: messages and reports name tasks by their ID
    "#]].assert_eq(&faults(
        r#"<component name="A"><implementation.java class="example.Robot001"/><property name="ID">R</property><property name="period">1</property></component>
<component name="B"><implementation.java class="example.Robot"/><property name="ID">R</property><property name="period">1</property><property name="number">2</property></component>
<component name="C"><implementation.java class="example.Clock"/><property name="ID">MEMS</property><property name="period">1</property></component>
<component name="D"><implementation.java class="example.Clock"/><property name="ID">MEMS</property><property name="period">1</property></component>
<component name="E"><implementation.java class="example.Clock"/><property name="ID">R</property><property name="period">1</property></component>"#,
    ));
}

#[test]
fn a_constructor_that_names_a_property_is_heard_at_its_value() {
    let given = faults(&robot(r#"<property name="speed">1.25</property>"#));
    assert!(given.starts_with("3:24-28 error S3014: component `R`: property `speed`: nobody"), "{given}");
    let by_source = faults(&format!(
        r#"<property name="pace">1.25</property>{}"#,
        robot(r#"<property name="speed" source="$pace"/>"#)
    ));
    assert!(by_source.starts_with("2:23-27 error S3014"), "{by_source}");
}

#[test]
fn constructors_have_the_last_word() {
    let found = faults(&format!(
        "{}\n<component name=\"F\"><implementation.java class=\"example.Fragile\"/></component>",
        robot(r#"<property name="speed">2.5</property><property name="colour">red</property>"#)
    ));
    let (before, place) = found.split_once("classes.rs:").unwrap();
    let (_, after) = place.split_once(": ").unwrap();
    expect![[r#"
        2:18-19 error S3014: component `R`: a red robot drives at most 2 m/s
          help: `saoms components example.Robot001` describes its properties
        5:18-19 error S3014: component `F`: panicked at saoms-lang/tests/suite/check/classes.rs: do not touch
          help: `saoms components example.Fragile` describes its properties
    "#]]
    .assert_eq(&format!("{before}classes.rs: {after}"));
}
