//! The built report page as it is committed: small, and with no way to the network.

use std::fs;
use std::path::Path;

/// Bytes at most: it is copied into every report.
const LARGEST: usize = 260_000;
/// Addresses that are names, never opened: the namespace of a drawing in the page.
const NAMES: [&str; 1] = ["http://www.w3.org/2000/svg"];
/// What a page loads or sends with.
const MEANS: [&str; 8] =
    ["fetch(", "XMLHttpRequest", "WebSocket", "EventSource", "sendBeacon", "importScripts", "@import", "serviceWorker"];

fn page() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    fs::read_to_string(root.join("host-sim/page/dist/report.html")).unwrap()
}

/// Every address with a scheme of the network in a text.
fn addresses(text: &str) -> Vec<&str> {
    let starts = ["http:", "https:", "ws:", "wss:", "ftp:"];
    let mut found: Vec<&str> = starts
        .iter()
        .flat_map(|scheme| text.match_indices(&format!("{scheme}//")).map(|(at, _)| at).collect::<Vec<_>>())
        .map(|at| text[at..].split(['"', '\'', '`', ' ', ')', '<', '>', '\n']).next().unwrap_or_default())
        .collect();
    found.sort_unstable();
    found
}

/// What is given to attributes and functions that load something. A name behind `#` is a thing of the page itself.
fn loaded(text: &str) -> Vec<&str> {
    let openings = [" src=", " href=", "url("];
    let behind = |opening: &'static str| text.match_indices(opening).map(move |(at, _)| &text[at + opening.len()..]);
    openings.into_iter().flat_map(behind).map(|rest| &rest[..rest.floor_char_boundary(40)]).collect()
}

#[test]
fn the_page_is_small_enough_to_be_part_of_every_report() {
    let size = page().len();
    assert!(size <= LARGEST, "{size} bytes, at most {LARGEST}");
}

#[test]
fn the_page_names_no_address_of_the_network() {
    let page = page();
    let foreign: Vec<&str> = addresses(&page).into_iter().filter(|a| !NAMES.contains(a)).collect();
    assert!(foreign.is_empty(), "{foreign:?}");
}

#[test]
fn the_page_loads_nothing_and_sends_nothing() {
    let page = page();
    for means in MEANS {
        assert!(!page.contains(means), "{means}");
    }
    let elsewhere: Vec<&str> = loaded(&page)
        .into_iter()
        .filter(|given| !["data:", "#"].iter().any(|own| given.trim_start_matches('"').starts_with(own)))
        .collect();
    assert!(elsewhere.is_empty(), "{elsewhere:?}");
    // Whatever slips in, the browser refuses it.
    assert!(page.contains(
        r#"content="default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; font-src data:""#
    ));
}

#[test]
fn the_place_for_the_data_is_there_once() {
    assert_eq!(page().matches(r#"<script type="application/json" id="truepath-data">null</script>"#).count(), 1);
}

#[test]
fn an_address_and_something_loaded_are_found() {
    let text = r#"<img src="pixel.png"> fetched from "https://example.org/a" or 'ws://example.org' <a href="data:,">"#;
    assert_eq!(addresses(text), ["https://example.org/a", "ws://example.org"]);
    assert_eq!(loaded(text).iter().filter(|given| given.contains("data:,")).count(), 1);
    assert!(loaded(text)[0].starts_with("\"pixel.png"));
}
