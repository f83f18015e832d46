//! The order of the rooms, as the diagram of the README has it.
//!
//! The diagram is the fenced block behind the heading [`HEADING`]:
//!
//! * `core/    units → rs274 → wire`: rooms in a folder, in their order. A name is a folder below it with packages, or a
//!   module of the package that lies in the folder itself, or the name of that package.
//! * `pocket, bore`, `sister/{pocket,bore}`: rooms between which there is no import.
//! * `tests/   whole-system tests`: without an arrow a folder is one room, and the rest is prose.
//! * What stands in parentheses is prose. A line that begins with a blank goes on with the one above.
//!
//! A room names only rooms that stand before it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::tree::{Forest, Import, places};

/// The heading above the diagram.
pub const HEADING: &str = "## How it works, and where";

/// A room of the diagram.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Room {
    /// As the diagram names it, with its folder.
    name: String,
    /// Its place in the order; rooms between which there is no import share one.
    level: usize,
    /// Which sources are in it.
    holds: Holds,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Holds {
    /// The packages in a folder and below it.
    Folder(PathBuf),
    /// The package of this number.
    Package(usize),
    /// A module of the package of this number.
    Module(usize, String),
}

/// What is wrong with the diagram itself, and every import against it with at most so many places.
pub fn objections(readme: &str, forest: &Forest, imports: &[Import], most: usize) -> Vec<String> {
    let Some(diagram) = diagram(readme) else { return vec![format!("README.md: no diagram behind “{HEADING}”")] };
    let (rooms, mut said) = rooms(diagram, forest);
    if !said.is_empty() {
        said.push(format!("The diagram under “{HEADING}” is read as the head of xtask/src/rooms/order.rs tells."));
    }
    for (number, package) in forest.packages.iter().enumerate() {
        let within = |room: &Room| match &room.holds {
            Holds::Folder(folder) => package.folder.starts_with(folder),
            Holds::Package(held) | Holds::Module(held, _) => *held == number,
        };
        if !rooms.iter().any(within) {
            said.push(format!(
                "README.md: {} ({}) is in no room of the diagram",
                package.folder.display(),
                package.name
            ));
        }
    }
    let room_of = |(tree, path): &(usize, Vec<String>)| room(&rooms, forest, forest.trees[*tree].package, path);
    let mut against: BTreeMap<(usize, usize), Vec<&Import>> = BTreeMap::new();
    for import in imports {
        let (Some(from), Some(to)) = (room_of(&import.from), room_of(&import.to)) else { continue };
        if from != to && rooms[from].level <= rooms[to].level {
            against.entry((from, to)).or_default().push(import);
        }
    }
    said.extend(against.into_iter().map(|((from, to), imports)| {
        let (from, to) = (&rooms[from], &rooms[to]);
        let stands = if from.level == to.level { "beside" } else { "behind" };
        let head = format!("README.md: {} names {}, which stands {stands} it in the diagram", from.name, to.name);
        head + &places(&imports, most, 4)
    }));
    said
}

/// The lines of the diagram.
fn diagram(readme: &str) -> Option<&str> {
    let (_, behind) = readme.split_once(HEADING)?;
    let (_, behind) = behind.split_once("\n```text\n")?;
    Some(behind.split_once("\n```")?.0)
}

/// The rooms in their order, and what cannot be read.
fn rooms(diagram: &str, forest: &Forest) -> (Vec<Room>, Vec<String>) {
    let (mut rooms, mut said) = (Vec::new(), Vec::new());
    let mut level = 0;
    for line in lines(diagram) {
        let (folder, names) = line.split_once(char::is_whitespace).unwrap_or((&line, ""));
        if !names.contains('→') {
            for named in line.split_whitespace().filter_map(|word| word.strip_suffix('/')) {
                level += 1;
                rooms.push(Room { name: named.to_owned(), level, holds: Holds::Folder(named.into()) });
            }
            continue;
        }
        let folder = PathBuf::from(folder.trim_end_matches('/'));
        for beside in names.split('→') {
            level += 1;
            for name in alternatives(beside) {
                match holds(forest, &folder, &name) {
                    Some(holds) => {
                        rooms.push(Room { name: folder.join(name).display().to_string(), level, holds });
                    }
                    None => said.push(format!(
                        "README.md: the diagram's “{name}” is neither a package nor a module in {}/",
                        folder.display()
                    )),
                }
            }
        }
    }
    (rooms, said)
}

/// The lines with those that go on with them, without what stands in parentheses.
fn lines(diagram: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for line in diagram.lines() {
        match lines.last_mut() {
            Some(above) if line.starts_with(char::is_whitespace) => *above += &format!(" {}", line.trim()),
            _ => lines.push(line.to_owned()),
        }
    }
    let without = |line: &String| {
        let mut depth = 0;
        let mut outside = |letter: &char| {
            depth += i32::from(*letter == '(') - i32::from(*letter == ')');
            depth == 0 && *letter != ')'
        };
        line.chars().filter(|letter| outside(letter)).collect::<String>()
    };
    lines.iter().map(without).collect()
}

/// Names between commas; `a/{b,c}` stands for `a/b` and `a/c`.
fn alternatives(names: &str) -> Vec<String> {
    if let Some((before, rest)) = names.split_once('{')
        && let Some((inner, behind)) = rest.split_once('}')
    {
        let head = before.rsplit(',').next().unwrap_or_default().trim();
        let before = &before[..before.rfind(',').unwrap_or(0)];
        let inner = inner.split(',').map(|name| format!("{head}{}", name.trim()));
        return alternatives(before).into_iter().chain(inner).chain(alternatives(behind)).collect();
    }
    names.split(',').map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect()
}

/// What a name of the diagram stands for.
fn holds(forest: &Forest, folder: &Path, name: &str) -> Option<Holds> {
    let below = folder.join(name);
    if forest.packages.iter().any(|package| package.folder.starts_with(&below)) {
        return Some(Holds::Folder(below));
    }
    let number = forest.packages.iter().position(|package| package.folder == *folder)?;
    if forest.packages[number].name == name {
        return Some(Holds::Package(number));
    }
    let own = |tree: usize| forest.trees[tree].package == number;
    let there = forest.modules.iter().any(|m| own(m.tree) && m.room.first().is_some_and(|first| first == name));
    there.then(|| Holds::Module(number, name.to_owned()))
}

/// The room that a module of a package is in: the narrowest.
fn room(rooms: &[Room], forest: &Forest, package: usize, path: &[String]) -> Option<usize> {
    let depth = |room: &Room| match &room.holds {
        Holds::Module(held, module) if *held == package && path.first() == Some(module) => Some(usize::MAX),
        Holds::Package(held) if *held == package => Some(usize::MAX - 1),
        Holds::Folder(folder) if forest.packages[package].folder.starts_with(folder) => {
            Some(folder.components().count())
        }
        _ => None,
    };
    let held = rooms.iter().enumerate().filter_map(|(number, room)| Some((depth(room)?, number)));
    held.max_by_key(|(depth, _)| *depth).map(|(_, number)| number)
}
