//! Fleets in few lines: replicas, and tables of what differs.

use expect_test::expect;

use crate::check::support::{faults_of, nested, outcome, part, shown};
use crate::check::values::files::checked;

/// A composite with the prefix of SAOMS.
pub(crate) fn fleet(inside: &str) -> String {
    part("fleet", "xmlns:saoms=\"urn:saoms:1\"", inside)
}

pub(crate) fn of(inside: &str, settings: &[&str]) -> String {
    outcome(&[&fleet(inside)], settings)
}

const ROBOTS: &str = r#"<property name="robots">3</property>
<component name="Robot${index:03}" saoms:count="robots"><implementation.java class="example.Robot"/>
<property name="ID">Robot${index:03}</property><property name="period" value="${100 + index}"/><property name="number">${index * 2 + 1}</property>
<property name="charger"><x xmlns="">${index % 2}</x><y xmlns="">${robots}</y></property>
<reference name="gps" target="Gps${ index }"/></component>
<component name="Gps${index}" saoms:count="robots"><implementation.java class="example.Gps"/></component>"#;

#[test]
fn replicas_have_their_index_in_names_values_and_targets() {
    expect![[r#"
        Robot001 (example.Robot) ID=Text("Robot001") number=Integer(3) charger=Complex([("x", Integer(1)), ("y", Integer(3))]) gps->Gps1/position
        Robot002 (example.Robot) ID=Text("Robot002") number=Integer(5) charger=Complex([("x", Integer(0)), ("y", Integer(3))]) gps->Gps2/position
        Robot003 (example.Robot) ID=Text("Robot003") number=Integer(7) charger=Complex([("x", Integer(1)), ("y", Integer(3))]) gps->Gps3/position
        Gps1 (example.Gps) other->
        Gps2 (example.Gps) other->
        Gps3 (example.Gps) other->
    "#]].assert_eq(&of(ROBOTS, &[]));
    expect![[r#"
        Robot001 (example.Robot) ID=Text("Robot001") number=Integer(3) charger=Complex([("x", Integer(1)), ("y", Integer(1))]) gps->Gps1/position
        Gps1 (example.Gps) other->
    "#]].assert_eq(&of(ROBOTS, &["robots=1"]));
    expect![""].assert_eq(&of(ROBOTS, &["robots=0"]));
    expect![[r#"
        3:104-125 warning S3017: `${...}` in `$${index} of ${index}` is not evaluated: the component has no `saoms:count`
          help: give the component a `saoms:count`, or write the value itself
        Gps-2 (example.Gps) other->
        Gps-1 (example.Gps) other->
        x (example.Reader) title=Text("$${index} of ${index}")
        B1 (example.Reader) title=Text("${index} of 1")
    "#]].assert_eq(&of(
        r#"<component name="Gps${index:02}" saoms:count="2" saoms:from="2 - 4"><implementation.java class="example.Gps"/></component>
<component name="B" saoms:path="x"><implementation.java class="example.Reader"/><property name="title">$${index} of ${index}</property></component>
<component name="B${index}" saoms:count="1"><implementation.java class="example.Reader"/><property name="title">$${index} of ${index}</property></component>"#,
        &[],
    ));
}

#[test]
fn a_star_names_all_replicas() {
    expect![[r#"
        N1 (example.Navigator) wheels->R01/move task->
        N2 (example.Navigator) wheels->R01/move task->
        R01 (example.Robot) ID=Text("R1") number=Integer(1) gps->G1/position
        R02 (example.Robot) ID=Text("R2") number=Integer(2) gps->G1/position
        G1 (example.Gps) other->
        G2 (example.Gps) other->
        C (example.Conductor) wheels->R01/move+R02/move gps->G1/position+G2/position
    "#]].assert_eq(&of(
        r#"<component name="N${index}" saoms:count="2"><implementation.java class="example.Navigator"/></component>
<component name="R${index:02}" saoms:count="2"><implementation.java class="example.Robot"/><property name="ID">R${index}</property><property name="period">1</property><property name="number">${index}</property></component>
<component name="G${index}" saoms:count="2"><implementation.java class="example.Gps"/></component>
<component name="C"><implementation.java class="example.Conductor"/><reference name="wheels" target="R*/move"/><reference name="gps" target="G*"/></component>
<wire source="N*/wheels" target="R01"/>
<wire source="R*/gps" target="G1"/>"#,
        &[],
    ));
    expect![[r#"
        2:119-121 error S2020: components call each other in a cycle: `G1` -> `G2` -> `G1`
          2:119-121 `G1` calls `G2` through `other`
          help: a call waits for its answer, and a component that waits cannot answer: remove one of the wires, or use a topic
        3:99-101 error S2011: there is no component `H*`
          fix: replace `H*` with `G*` [3:99-101 "G*"]
    "#]].assert_eq(&of(
        r#"<component name="G${index}" saoms:count="2"><implementation.java class="example.Gps"/><reference name="other" target="G*"/></component>
<component name="C"><implementation.java class="example.Conductor"/><reference name="gps" target="H*"/></component>"#,
        &[],
    ));
}

#[test]
fn the_index_of_replicas_and_all_of_them_are_not_for_every_place() {
    expect![[r#"
        2:28-30 error S2011: `G*` names all replicas, expected one component
          help: name one of them, such as `G1`
        4:99-108 error S2011: there is no component `G${index}`
          help: `${index}` works only inside replicas; use `*` to name all replicas
          fix: replace `G${index}` with `G*` [4:99-108 "G*"]
    "#]].assert_eq(&of(
        r#"<service name="s" promote="G*"/>
<component name="G${index}" saoms:count="2"><implementation.java class="example.Gps"/></component>
<component name="C"><implementation.java class="example.Conductor"/><reference name="gps" target="G${index}"/></component>"#,
        &[],
    ));
}

#[test]
fn composites_are_replicated_with_all_that_is_in_them() {
    let hall = part(
        "hall",
        "xmlns:saoms=\"urn:saoms:1\"",
        r#"<property name="hall">1</property><service name="s" promote="G1"/>
<component name="G${index}" saoms:count="hall"><implementation.java class="example.Gps"/></component>
<component name="R"><implementation.java class="example.Robot"/><property name="ID" source="$id"/><property name="period">1</property><property name="number" source="$hall"/></component>
<property name="id"/>"#,
    );
    let inside = r#"<component name="Hall${index}" saoms:count="2"><implementation.composite name="t:hall"/><property name="hall">${index}</property><property name="id">R${index}</property></component>
<component name="C"><implementation.java class="example.Conductor"/><reference name="gps" target="Hall*/s"/></component>"#;
    expect![[r#"
        Hall1/G1 (example.Gps) other->
        Hall1/R (example.Robot) ID=Text("R1") number=Integer(1) gps->
        Hall2/G1 (example.Gps) other->
        Hall2/G2 (example.Gps) other->
        Hall2/R (example.Robot) ID=Text("R2") number=Integer(2) gps->
        C (example.Conductor) wheels-> gps->Hall1/G1/position+Hall2/G1/position
    "#]]
    .assert_eq(&outcome(&[&fleet(inside), &hall], &[]));
    let wrong =
        inside.replace("${index}</property><property name=\"id\"", "${index * 60}</property><property name=\"id\"");
    expect![[r#"
        2:111-124 error S3008: property `number`: `120` is out of range: expected a whole number from 1 to 99 (in `Hall2/R`)
          hall:4:167-172 used here as `number`
          help: `number`: The number of the robot
    "#]].assert_eq(&outcome(
        &[&fleet(&wrong), &hall.replace("saoms:count=\"hall\"", "saoms:count=\"1\"")],
        &[],
    ));
}

/// Each of them has its texts.
#[test]
fn long_replicas_count_as_several() {
    let long = "x".repeat(1_000_000);
    let found = of(
        &format!(
            r#"<component name="A${{index}}" saoms:count="1000"><implementation.java class="example.Robot"/><property name="name">{long}</property></component>"#
        ),
        &[],
    );
    let told = "error S2046: 1000 replicas of this length are more than a fleet can have";
    assert_eq!(found.matches(told).count(), 1, "{}", found.len());
}

#[test]
fn what_is_wrong_with_replicas_is_found_at_its_place() {
    expect![[r#"
        3:18-19 error S2046: all replicas would have the name `A`
          fix: replace `A` with `A${index}` [3:18-19 "A${index}"]
        4:41-42 error S2046: `from` is for replicas, but the number of replicas is missing
          help: add `saoms:count="..."` to the component
        5:42-48 error S2046: there cannot be -1 replicas
          2:63-65 the value of `robots`
          help: write a number of 0 or more
        6:42-46 error S2046: 200000 replicas are more than a fleet can have
          2:98-104 the value of `many`
          help: use fewer: a fleet has at most 100000 replicas
        7:42-46 error S2045: found the text `north`, expected a whole number
          2:23-28 the value of `site`
          help: `docs/fleets.md` describes expressions
        8:21-26 error S2045: the composite has no property `inedx` (in `F${inedx}`, index 1, and in 1 more)
          fix: replace `inedx` with `index` [8:21-26 "index"]
        9:18-27 error S3006: component `G-1` needs the property `number` (index -1)
          help: add `<property name="number">...</property>`: a whole number from 1 to 99
        9:131-136 error S2045: division by zero: `index` is 0 (in `G0`, index 0)
          help: `docs/fleets.md` describes expressions
        10:18-31 error S2002: there are two components `H1` (index 3)
          help: give each its own name
        11:19-26 error S2045: `${` has no closing `}` (in `I${index`, index 1)
          help: write `${...}`, or `$${` for `${` itself
        12:27-28 error S2045: expected the number of digits after `:`, with a `0` before it (in `J${index:3}`, index 1)
          help: as in `${index:03}`, which turns 7 into 007
          fix: replace `3` with `03` [12:27-28 "03"]
        12:44-49 error S2045: the composite has no property `robts`
          fix: replace `robts` with `robots` [12:44-49 "robots"]
        13:29-40 error S1007: `component` has no attribute `saoms:cuont`
          fix: replace `saoms:cuont` with `saoms:count` [13:29-40 "saoms:count"]
        14:45-50 error S1007: `component` has no attribute `count`
          help: write it with a prefix of the namespace `urn:saoms:1`: it is an attribute of SAOMS
          fix: replace `count` with `saoms:count` [14:45-50 "saoms:count"]
        15:42-43 error S2046: the largest index does not fit into 64 bits
          help: choose a smaller `saoms:from`
        16:18-27 error S3006: component `N1` needs the property `ID` (index 1)
          help: add `<property name="ID">...</property>`: a text that is not empty
        16:128-131 error S2045: the composite has no property `nix`
          help: its properties are `many`, `robots` and `site`
    "#]].assert_eq(&of(
        r#"<property name="site">north</property><property name="robots">-1</property><property name="many">200000</property>
<component name="A" saoms:count="2"><implementation.java class="example.Gps"/></component>
<component name="B${index}" saoms:from="2"><implementation.java class="example.Gps"/></component>
<component name="C${index}" saoms:count="robots"><implementation.java class="example.Gps"/></component>
<component name="D${index}" saoms:count="many"><implementation.java class="example.Gps"/></component>
<component name="E${index}" saoms:count="site"><implementation.java class="example.Gps"/></component>
<component name="F${inedx}" saoms:count="2"><implementation.java class="example.Gps"/></component>
<component name="G${index}" saoms:count="3" saoms:from="-1"><implementation.java class="example.Robot"/><property name="ID">${1 / index}</property></component>
<component name="H${index % 2}" saoms:count="3"><implementation.java class="example.Gps"/></component>
<component name="I${index" saoms:count="1"><implementation.java class="example.Gps"/></component>
<component name="J${index:3}" saoms:count="robts"><implementation.java class="example.Gps"/></component>
<component name="K${index}" saoms:cuont="3"><implementation.java class="example.Gps"/></component>
<component name="L${index}" saoms:count="3" count="4"><implementation.java class="example.Gps"/></component>
<component name="M${index}" saoms:count="1" saoms:from="9223372036854775807"><implementation.java class="example.Gps"/></component>
<component name="N${index}" saoms:count="1"><implementation.java class="example.Robot"/><property name="charger"><x xmlns="">${nix}</x></property></component>"#,
        &[],
    ));
    expect![[r#"
        3:49-55 error S2046: 4000000 replicas are more than a fleet can have
          --set:1:8-15 the value of `robots`
          help: use fewer: a fleet has at most 100000 replicas
        5:66-75 error S3008: property `charger.y`: `4000000` is out of range: expected a whole number from 0 to 10 (in `Robot001`, index 1)
          help: the default is `0`
        7:44-50 error S2046: 4000000 replicas are more than a fleet can have
          --set:1:8-15 the value of `robots`
          help: use fewer: a fleet has at most 100000 replicas
    "#]]
    .assert_eq(&of(ROBOTS, &["robots=4000000"]));
}

#[test]
fn what_is_said_of_many_replicas_is_told_once() {
    expect![[r#"
        2:18-30 error S3006: component `R01` needs the property `period` (index 1, and in 11 more)
          help: add `<property name="period">...</property>`: a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
        3:21-22 error S3013: components `R01` and `R02` have the same `ID` `R` (index 2, and in 10 more)
          help: give every robot its own `ID`
          fix: replace `R` with `R${index}` [3:21-22 "R${index}"]
        3:57-70 error S3008: property `number`: `100` is out of range: expected a whole number from 1 to 99 (in `R10`, index 10, and in 2 more)
          help: `number`: The number of the robot
        3:97-101 error S3004: class `example.Robot` has no property `sped` (in `R01`, index 1, and in 11 more)
          fix: replace `sped` with `speed` [3:97-101 "speed"]
        3:138-143 error S3007: property `awake`: `maybe` is not a boolean: expected `true` or `false` (in `R01`, index 1, and in 11 more)
          help: the default is `true`
        4:31-40 error S2011: there is no component `G1` (in `R01`, index 1, and in 11 more)
          help: the components are `R02`, `R03`, `R04`, `R05`, `R06`, `R07`, `R08`, `R09`, `R10`, `R11`, `R12`, `X01`, `X02`, `X03`, `R*` and `X*`
          help: add a component of the class `example.Gps`
        5:76-90 error S3001: there is no class `example.Robott` (in `X01`, index 1, and in 2 more)
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          fix: replace `example.Robott` with `example.Robot` [5:76-90 "example.Robot"]
    "#]].assert_eq(&of(
        r#"<component name="R${index:02}" saoms:count="12"><implementation.java class="example.Robot"/>
<property name="ID">R</property><property name="number">${index * 10}</property><property name="sped">1</property><property name="awake">maybe</property>
<reference name="gps" target="G${index}"/></component>
<component name="X${index:02}" saoms:count="3"><implementation.java class="example.Robott"/></component>"#,
        &[],
    ));
    // An expression that is not different enough is not mended by another one behind what it came to.
    expect![[r#"
        3:21-34 error S3013: components `R2` and `R3` have the same `ID` `R1` (index 3)
          help: give every robot its own `ID`
          help: this value is the same for several replicas: `${index}` is different for each
    "#]].assert_eq(&of(
        r#"<component name="R${index}" saoms:count="3"><implementation.java class="example.Robot"/>
<property name="ID">R${index / 2}</property><property name="period">1</property><property name="number">${index % 2 + 1}</property></component>"#,
        &[],
    ));
}

#[test]
fn tables_say_what_differs() {
    let inside = r#"<component xmlns:saoms="urn:saoms:1" name="R${index:02}" saoms:count="4" saoms:overrides="robots.csv"><implementation.java class="example.Robot"/>
<property name="ID">R${index}</property><property name="period">100</property><property name="number">${index}</property></component>"#;
    let found = |table: &str| {
        let (assembly, found) = checked(inside, &[("robots.csv", table.as_bytes())], 1_000_000);
        let components = assembly.iter().flat_map(|assembly| &assembly.components);
        let values = components.map(|one| {
            let period = one.task.as_ref().unwrap().period;
            format!("{} {:?} {period:?}\n", one.path, one.values)
        });
        found + &values.collect::<String>()
    };
    expect![[r#"
        R01 [("ID", Text("R1")), ("number", Integer(1))] 100ms
        R02 [("ID", Text("R2")), ("number", Integer(2)), ("colour", Text("red"))] 100ms
        R03 [("ID", Text("R3")), ("number", Integer(3))] 100ms
        R04 [("ID", Text("R4")), ("number", Integer(4)), ("colour", Text("red"))] 200ms
    "#]]
    .assert_eq(&found("index,colour,period\n2,red,\n 4 ,\"red\",200\n"));
    expect![[r#"
        R01 [("ID", Text("R1")), ("number", Integer(1))] 100ms
        R02 [("ID", Text("R2")), ("number", Integer(2))] 100ms
        R03 [("ID", Text("R3")), ("number", Integer(30))] 100ms
        R04 [("ID", Text("R4")), ("number", Integer(4))] 100ms
    "#]]
    .assert_eq(&found("name,number\r\nR03,30\r\n\r\n"));
    // Empty rows, as spreadsheets leave them, say nothing; one with a value has to say about whom.
    expect![[r#"
        robots.csv:4:1-1 error S2047: this row does not name its replica
          help: use an index from 1 to 4
    "#]]
    .assert_eq(&found("index,colour\n\n,\n,red\n,\n"));
    expect![[r#"
        robots.csv:3:1-2 error S2047: this line has 2 values, but the table has 3 columns
          help: write an empty value, with its comma, for each property that the replica does not change
    "#]]
    .assert_eq(&found("index,colour,period\n2,red,\n3,blue\n"));
    expect![[r#"
        robots.csv:1:1-1 error S2047: the table is empty
          help: write a first line that names the columns: `index` or `name`, then properties
    "#]]
    .assert_eq(&found(""));
    expect![[r#"
        robots.csv:1:1-9 error S2047: a line that begins with `#`: tables have no comments
          help: remove the line, or write what it says into a comment of the composite
    "#]]
    .assert_eq(&found("# robots, of the hall\nindex,colour\n# 2,red\n2,blue\n"));
    expect![[r#"
        robots.csv:1:1-6 error S2047: the first column is `robot`, expected `index` or `name`
          help: the first column names the replica of a row; the other columns are properties
        robots.csv:1:14-20 error S2047: there are two columns `colour`
          robots.csv:1:7-13 the first
          help: merge them
        robots.csv:1:21-21 error S2047: a column without a name
          help: write a property name in the first line of each column
    "#]]
    .assert_eq(&found("robot,colour,colour,\n1,red,blue,x\n"));
    expect![[r#"
        robots.csv:2:3-6 error S3009: property `colour`: `rde` is not allowed: expected `red` or `blue` (in `R01`, index 1)
          help: the default is `blue`
          fix: replace `rde` with `red` [robots.csv:2:3-6 "red"]
        robots.csv:3:1-2 warning S2047: there is no replica `5`
          help: use an index from 1 to 4
        robots.csv:4:1-2 error S2047: two rows are for the replica `1`
          robots.csv:2:1-2 the first
          help: merge them
        robots.csv:4:9-10 error S2047: this line has 4 values, but the table has 3 columns
          help: write a value that contains a comma between two `"`
        robots.csv:5:1-2 error S2047: there is no replica `x`
          help: use an index from 1 to 4
        robots.csv:6:8-9 error S2047: `x` after a closing `"`
          help: write a `"` inside a quoted value twice
        robots.csv:6:10-11 error S2047: a `"` without a closing `"`
          help: write a `"` inside a quoted value twice
    "#]]
    .assert_eq(&found("index,colour,sped\n1,rde,\n5,red,\n1,blue,,7\nx,blue,2\n2,\"red\"x,\"1\n"));
    expect![[r#"
        robots.csv:2:1-3 error S2047: there is no replica `R3`
          fix: replace `R3` with `R03` [robots.csv:2:1-3 "R03"]
    "#]]
    .assert_eq(&found("name,speed\nR3,1\n"));
    // Whatever white space is around a value and wherever a line ends, the place is that of the value.
    expect![[r#"
        robots.csv:2:4-7 error S3009: property `colour`: `rde` is not allowed: expected `red` or `blue` (in `R01`, index 1)
          help: the default is `blue`
          fix: replace `rde` with `red` [robots.csv:2:4-7 "red"]
        robots.csv:3:9-10 error S2047: `x` after a closing `"`
          help: write a `"` inside a quoted value twice
        robots.csv:4:2-3 error S2047: there is no replica `x`
          help: use an index from 1 to 4
    "#]].assert_eq(&found("index,colour\r1,\u{a0}rde\u{2003}\r\n2,\"red\" x\r\n\u{3000}x\u{3000},red\r\n"));
    // What the table has already is not meant again; `R05` comes with a larger count, the others never.
    expect![[r#"
        robots.csv:5:1-4 warning S2047: there is no replica `R05`
          help: increase `saoms:count`, or remove the row
        robots.csv:6:1-3 error S2047: there is no replica `r1`
          help: replicas without a row are `R04`
          help: the replicas have the names `R${index:02}`
        robots.csv:7:1-2 error S2047: there is no replica `X`
          help: replicas without a row are `R04`
          help: the replicas have the names `R${index:02}`
    "#]]
    .assert_eq(&found("name,speed\nR01,1\nR02,1\nR03,1\nR05,1\nr1,1\nX,1\n"));
    expect![[r#"
        robots.csv:1:7-11 error S3004: class `example.Robot` has no property `sped` (in `R01`, index 1)
          fix: replace `sped` with `speed` [robots.csv:1:7-11 "speed"]
        robots.csv:3:4-7 error S3008: property `number`: `300` is out of range: expected a whole number from 1 to 99 (in `R02`, index 2)
          help: `number`: The number of the robot
        robots.csv:3:8-11 error S3009: property `colour`: `rde` is not allowed: expected `red` or `blue` (in `R02`, index 2)
          help: the default is `blue`
          fix: replace `rde` with `red` [robots.csv:3:8-11 "red"]
    "#]].assert_eq(&found("index,sped,number,colour\n1,7,70,\n2,,300,rde\n"));
    let (_, missing) = checked(inside, &[("robot.csv", b"")], 1_000_000);
    expect![[r#"
        2:91-101 error S0001: there is no such file
          help: the full path is `robots.csv`
          help: there is `robot.csv`
    "#]]
    .assert_eq(&missing);
}

#[test]
fn a_value_that_an_expression_needs_is_told_where_it_is_wrong_and_once() {
    let inside = r#"<property name="robots" type="xsd:int">2</property><property name="day" type="xsd:boolean">perhaps</property>
<component xmlns:saoms="urn:saoms:1" name="R${index}" saoms:count="robots + 1" saoms:if="day and index > 0"><implementation.java class="example.Robot"/>
<property name="ID">R${index}</property><property name="period">100</property><property name="number">${robots}</property></component>"#;
    expect![[r#"
        --set:1:8-12 error S2042: the property `robots` has the type `xsd:int`: found `many`, expected a whole number of 32 bits
          2:31-38 the type
          help: change the value, or the type
        2:31-38 warning S2050: the prefix `xsd` of this type is not declared
          fix: declare it in the root element: `xmlns:xsd="http://www.w3.org/2001/XMLSchema"` [1:11-11 " xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\""]
        2:92-99 error S2042: the property `day` has the type `xsd:boolean`: found `perhaps`, expected `true` or `false`
          2:79-90 the type
          help: change the value, or the type
    "#]].assert_eq(&faults_of(&[&crate::check::support::fleet(inside)], &["robots=many"]));
}

/// A few lines could ask for more wires than there is memory for.
#[test]
fn groups_that_call_groups_have_a_limit() {
    let group = r#"<component name="Gps${index}" saoms:count="1100"><implementation.java class="example.Gps"/><reference name="other" target="Gps*"/></component>"#;
    let found = of(group, &[]);
    let limit = "error S2035: the groups of replicas have more than 1000000 ends of wires";
    assert_eq!(found.matches(limit).count(), 1, "{found}");
}

#[test]
fn a_number_that_no_replica_has_means_the_nearest_that_one_has() {
    let gps = "<implementation.java class=\"example.Gps\"/></component>";
    let inside = format!(
        "<component name=\"R${{index:02}}\" saoms:count=\"2\">{gps}\n<component name=\"H7G${{index}}\" saoms:count=\"3\" saoms:from=\"5\">{gps}\n<component name=\"S${{index}}\" saoms:count=\"1\">{gps}\n<component name=\"C\"><implementation.java class=\"example.Conductor\"/><reference name=\"gps\" target=\"R03 R2 R99999999999999999999 R0\nH7G1 H7G9 S2 R0x\"/></component>"
    );
    expect![[r#"
        5:99-102 error S2011: there is no component `R03`
          help: the replicas are `R01` to `R02`
          fix: replace `R03` with `R02` [5:99-102 "R02"]
        5:103-105 error S2011: there is no component `R2`
          help: the replicas are `R01` to `R02`
          fix: replace `R2` with `R02` [5:103-105 "R02"]
        5:106-127 error S2011: there is no component `R99999999999999999999`
          help: the replicas are `R01` to `R02`
          fix: replace `R99999999999999999999` with `R02` [5:106-127 "R02"]
        5:128-130 error S2011: there is no component `R0`
          help: the replicas are `R01` to `R02`
          fix: replace `R0` with `R01` [5:128-130 "R01"]
        6:1-5 error S2011: there is no component `H7G1`
          help: the replicas are `H7G5` to `H7G7`
          fix: replace `H7G1` with `H7G5` [6:1-5 "H7G5"]
        6:6-10 error S2011: there is no component `H7G9`
          help: the replicas are `H7G5` to `H7G7`
          fix: replace `H7G9` with `H7G7` [6:6-10 "H7G7"]
        6:11-13 error S2011: there is no component `S2`
          help: the only replica is `S1`
          fix: replace `S2` with `S1` [6:11-13 "S1"]
        6:14-17 error S2011: there is no component `R0x`
          fix: replace `R0x` with `R01` [6:14-17 "R01"]
          fix: replace `R0x` with `R02` [6:14-17 "R02"]
    "#]]
    .assert_eq(&of(&inside, &[]));
    // Nothing follows the last one.
    let ring = "<component name=\"R${index:02}\" saoms:count=\"2\"><implementation.java class=\"example.Conductor\"/><reference name=\"gps\" target=\"R${index + 1:02}\"/></component>";
    let (_, found, sources) = nested(&[&fleet(ring)], &[], true);
    let found: String = found.iter().map(|one| shown(one, &sources)).collect();
    expect![[r#"
        2:126-142 error S2015: component `R02` offers no service with the interface `example.Positions` (in `R01`, index 1)
          help: it offers no services
        2:126-142 warning S2011: there is no component `R03` in these composites (in `R02`, index 2)
          help: the replicas are `R01` to `R02`
          help: it is not checked: another composite of the domain may have it
    "#]]
    .assert_eq(&found);
}
