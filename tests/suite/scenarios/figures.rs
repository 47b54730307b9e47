//! The console beside the manual's figures: what each of them shows, in its order and wording.
//!
//! Left out are the figures' dates, the lines of the original's libraries, and what their edges cut; robots have their
//! names throughout, where the figures sometimes write `Robot2` for `Robot002`.

use super::run::Run;

/// The lines without their dates.
fn console(composite: &str) -> Vec<String> {
    let run = Run::of(composite, 200);
    let console = run.console();
    console.iter().map(|line| line.split(" at 2015-01-23 ").next().unwrap().to_owned()).collect()
}

/// Checks that the console shows these lines one after the other.
fn assert_shows(console: &[String], figure: &str, lines: &str) {
    let lines: Vec<&str> = lines.lines().collect();
    let found = console.windows(lines.len()).any(|shown| shown == lines);
    let start = console.iter().position(|line| line == lines[0]);
    let near = start.map(|start| console[start..].iter().take(lines.len() + 1).collect::<Vec<_>>());
    assert!(found, "figure {figure}: expected\n{lines:#?}\nand found\n{near:#?}");
}

#[test]
fn scenario_1_reads_like_figures_8_1_to_8_7() {
    let console = console("scenario1.composite");
    let shows = |figure, lines| assert_shows(&console, figure, lines);
    shows(
        "8.1",
        "\
MasterEnvironmentManagingSystem starts
MasterRobotManagingSystem starts
Environment tests start
Environment: ready to test
Initialization of Robot001
Execution 0 of Robot001 starts",
    );
    shows(
        "8.2 and 8.3",
        "\
Environment: Test1: Luggage to bring from (3,1) to (3,10)
Execution 6 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: []
Robot001 luggage request list: []
Robot001 battery level: 100.0
MasterEnvironmentManagingSystem: new event received and managed
Environment: Test2: Luggage to bring from (1,5) to (10,5)
Execution 7 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (3,1) to (3,10)]
Robot001 is bringing luggage from (3,1) to (3,10)
Robot001 battery level: 100.0
MasterEnvironmentManagingSystem: new event received and managed
Environment: Test3: Luggage to bring from (10,8) to (1,8)
MasterEnvironmentManagingSystem: new event received and managed
Execution 8 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (1,5) to (10,5), Luggage to bring from (10,8) to (1,8)]
Robot001 says: My position now is: (0,1) and my next position will be: (1,1)
Robot001 battery level: 100.0",
    );
    shows(
        "8.4",
        "\
Execution 9 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (1,5) to (10,5), Luggage to bring from (10,8) to (1,8)]
Robot001 says: My position now is: (1,1) and my next position will be: (2,1)
Robot001 battery level: 100.0
Execution 10 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (1,5) to (10,5), Luggage to bring from (10,8) to (1,8)]
Robot001 says: My position now is: (2,1) and my next position will be: (3,1)",
    );
    shows(
        "8.5",
        "\
Robot001 says: I've arrived to destination.
Robot001 battery level: 74.0
Execution 23 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (1,5) to (10,5), Luggage to bring from (10,8) to (1,8)]
Robot001 says: Ready to deposit luggage in position (3,10)
Robot001 says: Luggage deposited.
Robot001 battery level: 72.0
Execution 24 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (1,5) to (10,5), Luggage to bring from (10,8) to (1,8)]
Robot001 is bringing luggage from (1,5) to (10,5)
Robot001 battery level: 70.0
Execution 25 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (10,8) to (1,8)]",
    );
    shows(
        "8.6",
        "\
Robot001 has low battery and is going under charge...
Robot001 says: My position now is: (1,1) and my next position will be: (0,1)
Robot001 needs to reach charge position as soon as possible!
Execution 59 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (10,8) to (1,8)]
Robot001 has low battery and is going under charge...
Robot001 says: I've arrived to charge position.
Execution 60 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: [New help request from Robot1]
Robot001 luggage request list: [Luggage to bring from (10,8) to (1,8)]",
    );
    shows(
        "8.7",
        "\
Execution 69 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: [New help request from Robot1]
Robot001 luggage request list: [Luggage to bring from (10,8) to (1,8)]
Robot001 is now fully charged and ready (but still asleep)
Robot1 is a new healer for Robot1
Robot001 battery level: 100.0
Execution 70 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (10,8) to (1,8)]
Robot001 is now fully charged and ready (but still asleep)
Robot001 is a healer and now is awake
Robot001 is bringing luggage from (10,8) to (1,8)",
    );
}

#[test]
fn scenario_2_reads_like_figures_8_9_to_8_16_and_8_19() {
    let console = console("scenario2.composite");
    let shows = |figure, lines| assert_shows(&console, figure, lines);
    shows(
        "8.9",
        "\
Execution 0 of Robot001 starts
Robot001 updated active robot list: []
Robot001 help request list: []
Robot001 luggage request list: []
Robot001 battery level: 100.0
Execution 0 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 help request list: []
Robot002 luggage request list: []
Robot002 battery level: 100.0
Execution 1 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 help request list: []
Robot001 luggage request list: []
Robot001 battery level: 100.0",
    );
    shows(
        "8.10",
        "\
Environment: Test1: Luggage to bring from (3,1) to (3,10)
Execution 6 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 help request list: []
Robot001 luggage request list: []
Robot001 battery level: 100.0
MasterEnvironmentManagingSystem: new event received and managed
Execution 6 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 help request list: []
Robot002 luggage request list: [Luggage to bring from (3,1) to (3,10)]
Robot002 is bringing luggage from (3,1) to (3,10)",
    );
    shows(
        "8.11",
        "\
Environment: Test2: Luggage to bring from (1,5) to (10,5)
Execution 7 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 help request list: []
Robot001 luggage request list: []
Robot001 battery level: 100.0
MasterEnvironmentManagingSystem: new event received and managed
Environment: Test3: Luggage to bring from (10,8) to (1,8)
Execution 7 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 help request list: []
Robot002 luggage request list: [Luggage to bring from (1,5) to (10,5)]
Robot002 says: My position now is: (0,2) and my next position will be: (1,2)
Robot002 battery level: 100.0
MasterEnvironmentManagingSystem: new event received and managed",
    );
    shows(
        "8.11, its end",
        "\
Execution 8 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 updated other robot position list: [Position of Robot2 will be: (1,2)]
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (1,5) to (10,5), Luggage to bring from (10,8) to (1,8)]
Robot001 is bringing luggage from (1,5) to (10,5)
Robot001 battery level: 100.0
MasterEnvironmentManagingSystem: new event received and managed
Execution 8 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 help request list: []
Robot002 luggage request list: [Luggage to bring from (10,8) to (1,8), Luggage to bring from (3,1) to (3,10)]
Robot002 says: My position now is: (1,2) and my next position will be: (2,2)
Robot002 battery level: 100.0",
    );
    shows(
        "8.12",
        "\
Execution 24 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 updated other robot position list: [Position of Robot2 will be: (3,10)]
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (10,8) to (1,8), Luggage to bring from (3,1) to (3,10)]
Robot001 says: My position now is: (9,5) and my next position will be: (10,5)
Robot001 battery level: 72.0
Execution 24 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 updated other robot position list: [Position of Robot1 will be: (10,5)]
Robot002 help request list: []
Robot002 luggage request list: [Luggage to bring from (10,8) to (1,8), Luggage to bring from (3,1) to (3,10)]
Robot002 says: Ready to deposit luggage in position (3,10)
Robot002 says: Luggage deposited.",
    );
    shows(
        "8.13",
        "\
Robot002 is bringing luggage from (10,8) to (1,8)
Robot002 battery level: 66.0
Execution 26 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (3,1) to (3,10)]",
    );
    shows(
        "8.14",
        "\
Execution 48 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 updated other robot position list: [Position of Robot1 will be: (3,9)]
Robot002 help request list: []
Robot002 luggage request list: []
Robot002 has low battery and is going under charge...
Robot002 says: My position now is: (1,8) and my next position will be: (1,7)
Robot002 battery level: 20.0",
    );
    shows(
        "8.15",
        "\
Robot002 says: I've arrived to charge position.
Execution 56 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 help request list: [New help request from Robot2]
Robot001 luggage request list: []
Robot001 has low battery and is going under charge...
Robot001 says: My position now is: (3,6) and my next position will be: (3,5)
Robot001 needs to reach charge position as soon as possible!
Execution 56 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 updated other robot position list: [Position of Robot1 will be: (3,5)]
Robot002 help request list: [New help request from Robot2]
Robot002 luggage request list: []
Robot002 battery level: 16.0
Execution 57 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 help request list: [New help request from Robot2]
Robot001 luggage request list: []
Robot001 has low battery and is going under charge...",
    );
    shows(
        "8.16",
        "\
Execution 65 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 help request list: [New help request from Robot2, New help request from Robot1]
Robot002 luggage request list: []
Robot002 is now fully charged and ready (but still asleep)
Robot2 is a new healer for Robot2
Robot002 battery level: 100.0
Execution 66 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 help request list: [New help request from Robot1]
Robot001 luggage request list: []
Robot001 battery level: 20.0
Execution 66 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 help request list: [New help request from Robot1]
Robot002 luggage request list: []
Robot002 is now fully charged and ready (but still asleep)
Robot002 is a healer and now is awake
Robot002 battery level: 100.0
Execution 67 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 help request list: [New help request from Robot1]
Robot001 luggage request list: []
Robot001 battery level: 30.0
Execution 67 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 help request list: [New help request from Robot1]
Robot002 luggage request list: []
Robot2 is a new healer for Robot1
Robot002 battery level: 100.0
Execution 68 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 help request list: []
Robot001 luggage request list: []
Robot001 battery level: 40.0
Execution 68 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 help request list: []
Robot002 luggage request list: []
Robot002 is a healer and awakes another robot",
    );
    shows(
        "8.19",
        "\
Execution 17 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 updated other robot position list: [Position of Robot2 will be: (3,5)]
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (10,8) to (1,8), Luggage to bring from (3,1) to (3,10)]
Robot001 says: My position now is: (2,5) and my next position will be: (3,5)
Robot001 battery level: 86.0
Execution 17 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 updated other robot position list: [Position of Robot1 will be: (3,5)]
Robot002 help request list: []
Robot002 luggage request list: [Luggage to bring from (10,8) to (1,8), Luggage to bring from (3,1) to (3,10)]
Robot002: RISK OF COLLISION DETECTED AND AVOIDED!
Robot002 battery level: 82.0
Execution 18 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 updated other robot position list: [Position of Robot2 will be: (3,5)]
Robot001 help request list: []
Robot001 luggage request list: [Luggage to bring from (10,8) to (1,8), Luggage to bring from (3,1) to (3,10)]
Robot001: RISK OF COLLISION DETECTED AND AVOIDED!
Robot001 says: My position now is: (3,5) and my next position will be: (4,5)
Robot001 battery level: 84.0
Execution 18 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 updated other robot position list: [Position of Robot1 will be: (4,5)]
Robot002 help request list: []
Robot002 luggage request list: [Luggage to bring from (10,8) to (1,8), Luggage to bring from (3,1) to (3,10)]
Robot002 says: My position now is: (3,5) and my next position will be: (3,6)
Robot002 battery level: 80.0",
    );
}

#[test]
fn scenario_3_reads_like_figure_8_18() {
    assert_shows(
        &console("scenario3.composite"),
        "8.18",
        "\
Environment: Test1: New event: LANDING with 4 expected pieces of luggage.
Execution 3 of Robot001 starts
Robot001 updated active robot list: [Robot2 is active]
Robot001 help request list: []
Robot001 luggage request list: []
Robot001 battery level: 100.0
MasterEnvironmentManagingSystem: new event received and managed
Execution 3 of Robot002 starts
Robot002 updated active robot list: [Robot1 is active]
Robot002 help request list: []
Robot002 luggage request list: []
Robot002 battery level: 100.0
MasterRobotManagingSystem updated active robot list: [Robot1 is active, Robot2 is active]",
    );
}
