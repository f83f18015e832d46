//! `docs/safety.md` names the tests that hold its table of the controller's end.

const DOCUMENT: &str = include_str!("../../../../docs/safety.md");
const TESTS: &str = include_str!("board_link.rs");

#[test]
fn the_table_of_the_controllers_end_names_tests_that_exist() {
    let (_, behind) = DOCUMENT.split_once("## When the board is not heard").unwrap();
    let section = behind.split("\n## ").next().unwrap();
    let named: Vec<&str> = section
        .lines()
        .filter(|line| line.starts_with("| ") && line.contains('`'))
        .filter_map(|line| line.trim_end_matches('|').rsplit_once('|'))
        .flat_map(|(_, tests)| tests.split('`').skip(1).step_by(2))
        .collect();
    assert!(named.len() > 8, "{named:?}");
    for name in named.iter().filter(|name| !name.ends_with(".rs")) {
        assert!(TESTS.contains(&format!("#[test]\nfn {name}()")), "{name}");
    }
}
