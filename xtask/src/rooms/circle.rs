//! Import circles among the modules of one folder.
//!
//! An import from `a::x` to `a::y::z` is one from `x` to `y` in the folder `a`. The folder's own file (`mod.rs`, `lib.rs`)
//! is one of the rooms in it: what it declares may be used by those beside it only when it uses none of them.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::tree::{Import, places};

/// A room within its folder; `None` is the folder's own file.
type Room = Option<String>;
/// The imports of one room by another.
type Edges<'a> = BTreeMap<(Room, Room), Vec<&'a Import>>;

/// A folder: number of the tree, place of the folder in it.
pub type Folder = (usize, Vec<String>);

/// A circle with the imports that make it, one list for each step.
#[derive(Clone, Debug)]
pub struct Circle<'a> {
    /// Where it lies.
    pub folder: Folder,
    /// The rooms; behind the last comes the first again.
    rooms: Vec<Room>,
    /// The imports of the next room by each.
    steps: Vec<Vec<&'a Import>>,
}

/// Circles of all folders. Of each knot the shortest circle comes first; then, as though its thinnest step were cut,
/// the next one, until none is left: who cuts them all is done.
pub fn circles(imports: &[Import]) -> Vec<Circle<'_>> {
    let mut folders: BTreeMap<Folder, Edges> = BTreeMap::new();
    for import in imports {
        let ((tree, from), (other, to)) = (&import.from, &import.to);
        if tree != other {
            continue;
        }
        let shared = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        let room = |path: &[String]| path.get(shared).cloned();
        let edges = folders.entry((*tree, from.iter().take(shared).cloned().collect())).or_default();
        edges.entry((room(from), room(to))).or_default().push(import);
    }
    let mut found = Vec::new();
    for (folder, mut edges) in folders {
        while let Some(rooms) = shortest(&edges) {
            let next = rooms.iter().cycle().skip(1);
            let pairs: Vec<(Room, Room)> = rooms.iter().cloned().zip(next.cloned()).collect();
            let steps: Vec<Vec<&Import>> = pairs.iter().map(|pair| edges[pair].clone()).collect();
            if let Some((_, thinnest)) = steps.iter().zip(&pairs).min_by_key(|(step, _)| step.len()) {
                edges.remove(thinnest);
            }
            found.push(Circle { folder: folder.clone(), rooms, steps });
        }
    }
    found
}

/// The shortest circle, of several the one of the first room by name.
fn shortest(edges: &Edges) -> Option<Vec<Room>> {
    let rooms: BTreeSet<&Room> = edges.keys().map(|(from, _)| from).collect();
    let circles = rooms.into_iter().filter_map(|room| way_back(edges, room));
    circles.min_by_key(Vec::len)
}

/// The shortest way from a room to itself.
fn way_back(edges: &Edges, start: &Room) -> Option<Vec<Room>> {
    let mut reached: BTreeMap<&Room, &Room> = BTreeMap::new();
    let mut next = VecDeque::from([start]);
    while let Some(at) = next.pop_front() {
        for (_, to) in edges.keys().filter(|(from, _)| from == at) {
            if to == start {
                let mut way = vec![at.clone()];
                let mut back = at;
                while let Some(before) = reached.get(back) {
                    way.push((*before).clone());
                    back = before;
                }
                way.reverse();
                return Some(way);
            }
            if !reached.contains_key(to) {
                reached.insert(to, at);
                next.push_back(to);
            }
        }
    }
    None
}

impl Circle<'_> {
    /// The circle in words: its rooms, then what each step consists of, at most so many places.
    pub fn describe(&self, crate_name: &str, most: usize) -> String {
        let folder: Vec<&str> = std::iter::once(crate_name).chain(self.folder.1.iter().map(String::as_str)).collect();
        let own = self.own_file();
        let name = |room: &Room| room.clone().unwrap_or_else(|| own.clone());
        let around: Vec<String> = self.rooms.iter().chain(self.rooms.first()).map(name).collect();
        let mut text = format!("{}: {}", folder.join("::"), around.join(" → "));
        for (step, rooms) in self.steps.iter().zip(around.windows(2)) {
            text += &format!("\n    {} names {}{}", rooms[0], rooms[1], places(step, most, 8));
        }
        text
    }

    /// The name of the folder's own file, as `mod.rs`.
    fn own_file(&self) -> String {
        let own = self.steps.iter().flatten().find(|import| import.from.1 == self.folder.1);
        own.and_then(|import| Some(import.file.file_name()?.to_string_lossy().into_owned())).unwrap_or_default()
    }
}
