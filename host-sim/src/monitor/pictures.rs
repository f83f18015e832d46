//! Pictures of the views as text, in files beside their tests and in the documents.

use std::path::Path;

use ratatui::buffer::Buffer;
use truepath_core::link::{Spread, Timing};

/// The letters of a picture, without blanks at the ends of lines.
pub fn text(buffer: &Buffer) -> String {
    let rows = buffer.content.chunks(usize::from(buffer.area.width));
    let line = |row: &[ratatui::buffer::Cell]| row.iter().map(|cell| cell.symbol()).collect::<String>();
    rows.map(|row| format!("{}\n", line(row).trim_end())).collect()
}

/// Setpoints at 1 kHz, most of them within 20 µs of their time, one very late.
pub fn timing() -> Timing {
    let spread = |count, mean_ns, deviation_ns, least_ns, greatest_ns| Spread {
        count,
        mean_ns,
        deviation_ns,
        least_ns,
        greatest_ns,
    };
    Timing {
        period_ns: 1_000_000,
        arrivals: spread(14_990, 40, 12_300, -50_000, 121_000),
        early: [402, 410, 1_280, 1_610, 2_020, 1_260, 3, 0, 0, 0, 0],
        late: [390, 420, 1_310, 1_590, 2_060, 1_230, 960, 44, 1, 0, 0],
        answers: spread(14_991, 8_100, 320, 7_600, 12_000),
        taken: [0, 0, 0, 14_902, 89, 0, 0, 0, 0, 0, 0],
        missed: 0,
    }
}

fn blesses() -> bool {
    std::env::var_os("BLESS").is_some()
}

/// Compares a picture with its file; `BLESS=1 cargo test` renews the file.
pub fn is_as_in_its_file(folder: &str, name: &str, text: &str) {
    let path = Path::new(folder).join(format!("{name}.txt"));
    if blesses() {
        std::fs::write(&path, text).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap().replace("\r\n", "\n");
    assert!(kept == text, "{} (BLESS=1 renews it) has\n{kept}\nand it is\n{text}", path.display());
}

/// Compares a picture with the one in `docs/bench.md`, between the comments that name it; `BLESS=1` renews that.
pub fn is_as_in_the_documents(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join("docs/bench.md");
    let document = std::fs::read_to_string(&path).unwrap().replace("\r\n", "\n");
    let [begin, end] = [format!("<!-- view of {name} -->\n"), format!("<!-- end of {name} -->")];
    let from = document.find(&begin).unwrap() + begin.len();
    let to = from + document[from..].find(&end).unwrap();
    let wanted = format!("```text\n{text}```\n");
    if blesses() && document[from..to] != wanted {
        std::fs::write(&path, [&document[..from], &wanted, &document[to..]].concat()).unwrap();
    } else {
        assert!(document[from..to] == wanted, "docs/bench.md (BLESS=1 renews it): {name} is now\n{text}");
    }
}
