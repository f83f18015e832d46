//! Worst-case stack: frames added along the call graph, from the thread and from each interrupt priority.
//!
//! All priorities share one stack, and each can interrupt the one below it once, so their worst cases add up. Calls
//! through a register do not show where they lead; `priorities` says it for every function that has one and is
//! reached, and a function that is missing there is a finding. Recursion is a finding unless `priorities` bounds it.

use std::collections::BTreeMap;

use super::graph::Graph;

/// What the processor puts on the stack for an exception: 26 words with the floats, and one to align.
const EXCEPTION: u32 = 27 * 4;

/// A priority: its name, its roots by name (the worst counts), and whether it is the thread.
pub struct Level {
    /// Its name in the table.
    pub name: &'static str,
    /// Functions the hardware enters at it.
    pub roots: &'static [&'static str],
    /// Whether an exception frame comes with it.
    pub exception: bool,
}

/// Where calls through a register lead: a part of the caller's name and parts of the names of those called.
pub type Indirect = (&'static str, &'static [&'static str]);

/// Functions that call themselves, directly or not, with the reason why that ends, and how deep it goes.
pub type Recursion = (&'static str, u32);

/// The worst case from a root, with the way there.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Depth {
    /// Bytes.
    pub bytes: u32,
    /// Names from the root on.
    pub way: Vec<String>,
}

/// A search that remembers.
pub struct Search<'a> {
    graph: &'a Graph,
    indirect: &'a [Indirect],
    recursion: &'a [Recursion],
    known: BTreeMap<u32, Depth>,
    on_the_way: Vec<u32>,
    /// What cannot be said.
    pub doubts: Vec<String>,
}

impl<'a> Search<'a> {
    /// Over a graph.
    pub fn new(graph: &'a Graph, indirect: &'a [Indirect], recursion: &'a [Recursion]) -> Self {
        Self { graph, indirect, recursion, known: BTreeMap::new(), on_the_way: Vec::new(), doubts: Vec::new() }
    }

    /// The worst case of a priority.
    pub fn level(&mut self, level: &Level) -> Depth {
        let mut worst = Depth::default();
        for root in level.roots {
            let found: Vec<u32> =
                self.graph.functions.iter().filter(|(_, f)| f.name == *root).map(|(&a, _)| a).collect();
            if found.is_empty() {
                self.doubts.push(format!("{}: no function {root}", level.name));
            }
            for start in found {
                let depth = self.from(start);
                if depth.bytes > worst.bytes {
                    worst = depth;
                }
            }
        }
        worst.bytes += if level.exception { EXCEPTION } else { 0 };
        worst
    }

    fn from(&mut self, start: u32) -> Depth {
        if let Some(depth) = self.known.get(&start) {
            return depth.clone();
        }
        let Some(function) = self.graph.functions.get(&start) else { return Depth::default() };
        if let Some(place) = self.on_the_way.iter().position(|&f| f == start) {
            let name = |address: &u32| self.graph.functions.get(address).map_or("", |f| f.name.as_str());
            let cycle: Vec<&str> = self.on_the_way.iter().skip(place).map(name).collect();
            let bound = self.recursion.iter().find(|(part, _)| cycle.iter().any(|name| name.contains(part)));
            let Some(&(_, times)) = bound else {
                self.doubts.push(format!("recursion: {}", cycle.join(" → ")));
                return Depth::default();
            };
            // Once around is counted where the cycle begins; this is the rest.
            let around: u32 =
                self.on_the_way.iter().skip(place).filter_map(|f| self.graph.functions.get(f)?.frame).sum();
            return Depth { bytes: around * times, way: vec![format!("({times} times around)")] };
        }
        self.on_the_way.push(start);
        let mut next: Vec<u32> = function.calls.iter().copied().collect();
        if function.indirect {
            let lists: Vec<&[&str]> =
                self.indirect.iter().filter(|(caller, _)| function.name.contains(caller)).map(|(_, to)| *to).collect();
            if lists.is_empty() {
                self.doubts.push(format!("{} calls through a register; nobody says where to", function.name));
            }
            for part in lists.into_iter().flatten() {
                let before = next.len();
                next.extend(self.graph.named(part));
                if next.len() == before {
                    self.doubts.push(format!("{} is said to call {part}, which is not there", function.name));
                }
            }
        }
        let below =
            next.into_iter().map(|callee| self.from(callee)).max_by_key(|depth| depth.bytes).unwrap_or_default();
        self.on_the_way.pop();
        if function.frame.is_none() {
            self.doubts.push(format!("the frame of {} is not known", function.name));
        }
        let mut way = vec![format!("{} {}", function.frame.unwrap_or(0), function.name)];
        way.extend(below.way);
        let depth = Depth { bytes: below.bytes + function.frame.unwrap_or(0), way };
        // A depth that was cut off within a cycle holds only on this way.
        if self.on_the_way.is_empty() || depth.way.last().is_none_or(|last| !last.starts_with('(')) {
            self.known.insert(start, depth.clone());
        }
        depth
    }
}

#[cfg(test)]
mod tests {
    use super::super::graph::Function;
    use super::*;

    fn graph(functions: &[(u32, &str, u32, &[u32], bool)]) -> Graph {
        let functions = functions.iter().map(|&(at, name, frame, calls, indirect)| {
            let calls = calls.iter().copied().collect();
            (at, Function { name: name.to_owned(), frame: Some(frame), calls, indirect })
        });
        Graph { functions: functions.collect(), ..Graph::default() }
    }

    const ROOT: Level = Level { name: "thread", roots: &["main"], exception: false };

    #[test]
    fn the_deepest_way_counts_not_the_sum_of_all() {
        let graph = graph(&[
            (0, "main", 8, &[2, 4], false),
            (2, "a", 100, &[6], false),
            (4, "b", 90, &[6], false),
            (6, "c", 16, &[], false),
        ]);
        let mut search = Search::new(&graph, &[], &[]);
        assert_eq!(search.level(&ROOT).bytes, 124);
        assert!(search.doubts.is_empty());
    }

    #[test]
    fn recursion_and_calls_through_registers_are_doubts_unless_somebody_answers_for_them() {
        let graph = graph(&[
            (0, "main", 8, &[2], true),
            (2, "sort", 40, &[2, 4], false),
            (4, "c", 16, &[2], false),
            (6, "task", 200, &[], false),
        ]);
        let mut search = Search::new(&graph, &[], &[]);
        search.level(&ROOT);
        assert_eq!(search.doubts.len(), 3, "{:?}", search.doubts);
        let mut search = Search::new(&graph, &[("main", &["task"])], &[("sort", 3)]);
        // main 8, then once around (sort 40, c 16), then three times more: more than the task's 200.
        assert_eq!(search.level(&ROOT).bytes, 8 + 56 * 4);
        assert!(search.doubts.is_empty(), "{:?}", search.doubts);
    }
}
