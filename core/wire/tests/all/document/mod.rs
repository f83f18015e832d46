//! Tables of a page of the documentation, to be compared with the code.

/// The text of a page in `docs`.
pub fn page(name: &str) -> String {
    let path = format!("{}/../../docs/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The rows of the table under the heading that begins with `section` whose head begins with `head`, without the head.
pub fn table(page: &str, section: &str, head: &str) -> Vec<Vec<String>> {
    let mut lines = page.lines().skip_while(|line| !(line.starts_with('#') && line.contains(section)));
    let found = lines.by_ref().skip(1).take_while(|line| !line.starts_with("## ")).any(|line| line.starts_with(head));
    assert!(found, "no table {head} under {section}");
    let rows = lines.skip(1).take_while(|line| line.starts_with('|')).map(cells);
    let rows: Vec<_> = rows.collect();
    assert!(!rows.is_empty());
    rows
}

fn cells(line: &str) -> Vec<String> {
    line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
}

/// The value of an expression of the tables such as `20 + 8 n`.
pub fn value(expression: &str, n: usize) -> usize {
    let number = |text: &str| text.trim().parse::<usize>().unwrap_or_else(|_| panic!("{expression}"));
    let term = |text: &str| match text.trim().strip_suffix('n') {
        Some(factor) => number(factor) * n,
        None => number(text),
    };
    expression.split('+').map(term).sum()
}

/// The words in backquotes of a cell.
pub fn quoted(cell: &str) -> Vec<String> {
    cell.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// Name and field names of a value as the derived `Debug` prints it, the outermost ones only.
pub fn fields(debug: &str) -> (String, Vec<String>) {
    let name: String = debug.chars().take_while(|c| c.is_alphanumeric()).collect();
    let Some(body) = debug.strip_prefix(&name).and_then(|rest| rest.trim_start().strip_prefix('{')) else {
        return (name, vec![]);
    };
    let (mut depth, mut found, mut word) = (0, vec![], String::new());
    for c in body.chars() {
        match c {
            '{' | '(' | '[' => depth += 1,
            '}' | ')' | ']' => depth -= 1,
            ':' if depth == 0 => found.push(std::mem::take(&mut word)),
            c if depth == 0 && (c.is_alphanumeric() || c == '_') => word.push(c),
            _ => word.clear(),
        }
    }
    (name, found)
}
