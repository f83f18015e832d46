//! Module trees of all crates, and where a path leads.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::package::Package;
use super::source::{self, Source};
use crate::step::Failure;

/// Gives the text of a file by its path from the root of the repository.
pub type Text<'a> = &'a dyn Fn(&Path) -> Option<String>;

/// Number of a module.
pub type Id = usize;

/// A module.
#[derive(Debug)]
pub struct Module {
    /// Number of its tree.
    pub tree: usize,
    /// The module around it; `None` of a root.
    parent: Option<Id>,
    /// Its place in the tree. A module written in place has that of its file: it is no room of its own.
    pub room: Vec<String>,
    /// Its file, relative to the root of the repository.
    pub file: PathBuf,
    /// Its items, modules and imports by name.
    members: BTreeMap<String, Vec<Member>>,
    /// The modules that a `use …::*` opens.
    opens: BTreeSet<Id>,
    source: Source,
}

#[derive(Clone, Debug)]
enum Member {
    Module(Id),
    Item,
    Import(Vec<String>),
}

impl Member {
    fn module(&self) -> Option<Id> {
        if let Self::Module(id) = self { Some(*id) } else { None }
    }
}

/// A library or a program with its modules.
#[derive(Debug)]
pub struct Tree {
    /// Number of its package.
    pub package: usize,
    /// The module it begins with.
    root: Id,
    /// Whether others may name it.
    library: bool,
}

/// All trees of the workspace.
#[derive(Debug, Default)]
pub struct Forest {
    /// The packages.
    pub packages: Vec<Package>,
    /// The trees.
    pub trees: Vec<Tree>,
    /// The modules of all trees.
    pub modules: Vec<Module>,
}

/// An import: one room names another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Import {
    /// Tree and room that names.
    pub from: (usize, Vec<String>),
    /// Tree and room that is named.
    pub to: (usize, Vec<String>),
    /// The file, relative to the root.
    pub file: PathBuf,
    /// The line, from 1.
    pub line: usize,
    /// The path as it is written.
    pub path: String,
}

/// How many imports there are, and the first so many of them, each on a line of its own with this indentation.
pub fn places(imports: &[&Import], most: usize, indentation: usize) -> String {
    let count = if imports.len() == 1 { "1 place".to_owned() } else { format!("{} places", imports.len()) };
    let lines = imports
        .iter()
        .take(most)
        .map(|import| format!("\n{:indentation$}{}:{}  {}", "", import.file.display(), import.line, import.path));
    format!(" in {count}{}", lines.collect::<String>())
}

/// Where a path leads: the module that declares its item, and whether the path ends in the module itself.
type Places = BTreeSet<(Id, bool)>;

impl Forest {
    /// Reads all sources of the packages; `text` gives the text of a file that is there.
    ///
    /// # Errors
    /// A file that is not there or not Rust.
    pub fn read(text: Text, packages: Vec<Package>) -> Result<Self, Failure> {
        let mut forest = Self::default();
        for (number, package) in packages.iter().enumerate() {
            let library = package.library.iter().map(|file| (file, true));
            for (file, library) in library.chain(package.programs.iter().map(|file| (file, false))) {
                let folder = file.parent().unwrap_or(Path::new("")).to_owned();
                let tree = forest.trees.len();
                let source = parsed(text, file)?;
                forest.trees.push(Tree { package: number, root: forest.modules.len(), library });
                forest.add(text, Place { tree, parent: None, room: Vec::new(), file, folder }, source)?;
            }
        }
        forest.packages = packages;
        // What one glob opens may name what another one does.
        while forest.open() {}
        Ok(forest)
    }

    /// Adds a module and those in it; `folder` is where the files of its own modules lie.
    fn add(&mut self, text: Text, place: Place, mut source: Source) -> Result<Id, Failure> {
        let id = self.modules.len();
        let (files, inline) = (std::mem::take(&mut source.files), std::mem::take(&mut source.inline));
        let mut members: BTreeMap<String, Vec<Member>> = BTreeMap::new();
        for item in &source.items {
            members.entry(item.clone()).or_default().push(Member::Item);
        }
        for used in &source.uses {
            if let Some(name) = &used.binds {
                members.entry(name.clone()).or_default().push(Member::Import(used.path.clone()));
            }
        }
        let Place { tree, parent, room, file, folder } = place;
        self.modules.push(Module {
            tree,
            parent,
            room: room.clone(),
            file: file.to_owned(),
            members,
            opens: BTreeSet::new(),
            source,
        });
        for (name, given) in files {
            // A given path counts from the folder of the file that gives it.
            let beside = file.parent().unwrap_or(Path::new(""));
            let places = match given {
                Some(given) => vec![beside.join(given)],
                None => vec![folder.join(format!("{name}.rs")), folder.join(&name).join("mod.rs")],
            };
            let Some(inner) = places.iter().find(|file| text(file).is_some()) else {
                return Err(Failure::found(format!("{}: no file of its module {name}", file.display())));
            };
            let own = inner.file_name().is_some_and(|n| n == "mod.rs");
            let below = if own { inner.parent().map(Path::to_owned) } else { Some(inner.with_extension("")) };
            let room = [room.clone(), vec![name.clone()]].concat();
            let place = Place { tree, parent: Some(id), room, file: inner, folder: below.unwrap_or_default() };
            let child = self.add(text, place, parsed(text, inner)?)?;
            self.declare(id, name, child);
        }
        for (name, source) in inline {
            let place = Place { tree, parent: Some(id), room: room.clone(), file, folder: folder.join(&name) };
            let child = self.add(text, place, source)?;
            self.declare(id, name, child);
        }
        Ok(id)
    }

    fn declare(&mut self, module: Id, name: String, child: Id) {
        if let Some(module) = self.modules.get_mut(module) {
            module.members.entry(name).or_default().push(Member::Module(child));
        }
    }

    /// Finds the modules that globs open; whether there are new ones.
    fn open(&mut self) -> bool {
        let mut found = Vec::new();
        for (id, module) in self.modules.iter().enumerate() {
            for glob in module.source.uses.iter().filter(|used| used.binds.is_none()) {
                let opened = self.places(id, &glob.path).into_iter().filter(|(to, module)| *module && *to != id);
                found.extend(opened.map(|(to, _)| (id, to)));
            }
        }
        found.into_iter().fold(false, |new, (id, to)| self.modules[id].opens.insert(to) || new)
    }

    /// Every import of one room by another, in the order of files and lines. A name that a `use` of its file brought in
    /// counts there and not again.
    pub fn imports(&self) -> Vec<Import> {
        let mut found = BTreeSet::new();
        for (id, module) in self.modules.iter().enumerate() {
            let from = (module.tree, module.room.clone());
            let mut add = |places: Places, path: &[String], line: usize, known: &BTreeSet<(usize, Vec<String>)>| {
                for to in places.into_iter().map(|(to, _)| &self.modules[to]) {
                    let to = (to.tree, to.room.clone());
                    if from != to && !known.contains(&to) {
                        let (file, path) = (module.file.clone(), path.join("::"));
                        found.insert(Import { from: from.clone(), to: to.clone(), file, line, path });
                    }
                }
            };
            let mut used_here = BTreeSet::new();
            for used in &module.source.uses {
                // What a module hands on of its own parts is not used by it, and `use super::*` brings in names of
                // which each counts where it stands.
                let handed_on =
                    |to: &Module| used.public && to.tree == module.tree && to.room.starts_with(&module.room);
                let opened =
                    |to: &Module| used.binds.is_none() && to.tree == module.tree && module.room.starts_with(&to.room);
                let counts = |to: &Module| !handed_on(to) && !opened(to);
                let mut places = self.places(id, &used.path);
                places.retain(|(to, _)| counts(&self.modules[*to]));
                let rooms = places.iter().map(|(to, _)| (self.modules[*to].tree, self.modules[*to].room.clone()));
                used_here.extend(rooms);
                add(places, &used.path, used.line, &BTreeSet::new());
            }
            for name in &module.source.names {
                let mut places = self.places(id, &name.path);
                // A single name that is also a module's is a variable.
                if name.path.len() == 1 {
                    places.retain(|(_, module)| !module);
                }
                add(places, &name.path, name.line, &used_here);
            }
        }
        found.into_iter().collect()
    }

    /// Where a path leads that is written in a module.
    fn places(&self, from: Id, path: &[String]) -> Places {
        let mut places = Places::new();
        self.follow(from, path, &mut BTreeSet::new(), &mut places);
        places
    }

    fn follow(&self, from: Id, path: &[String], seen: &mut BTreeSet<(Id, Vec<String>)>, places: &mut Places) {
        if !seen.insert((from, path.to_vec())) {
            return;
        }
        let Some((first, rest)) = path.split_first() else {
            places.insert((from, true));
            return;
        };
        match first.as_str() {
            "crate" => {
                self.descend(self.trees[self.modules[from].tree].root, rest, seen, places);
            }
            // Another `super` may follow either.
            "self" if rest.first().is_some_and(|next| next == "super") => self.follow(from, rest, seen, places),
            "self" => {
                self.descend(from, rest, seen, places);
            }
            "super" => match self.modules[from].parent {
                Some(parent) if rest.first().is_some_and(|next| next == "super") => {
                    self.follow(parent, rest, seen, places);
                }
                Some(parent) => {
                    self.descend(parent, rest, seen, places);
                }
                None => {}
            },
            "" => self.follow_crate(from, rest, seen, places),
            _ => {
                if !self.descend(from, path, seen, places) {
                    self.follow_crate(from, path, seen, places);
                }
            }
        }
    }

    /// A path that begins with the name of another crate. Both count: the crate that is named, and the one that what
    /// it hands on comes from.
    fn follow_crate(&self, from: Id, path: &[String], seen: &mut BTreeSet<(Id, Vec<String>)>, places: &mut Places) {
        let Some((name, rest)) = path.split_first() else { return };
        let package = &self.packages[self.trees[self.modules[from].tree].package];
        let Some((_, wanted)) = package.dependencies.iter().find(|(in_sources, _)| in_sources == name) else { return };
        let named = self.trees.iter().find(|tree| tree.library && self.packages[tree.package].name == *wanted);
        if let Some(tree) = named {
            let mut found = Places::new();
            self.descend(tree.root, rest, seen, &mut found);
            // A name that is not found, for instance one a macro makes, is the crate's own.
            if !found.iter().any(|(to, _)| self.trees[self.modules[*to].tree].root == tree.root) {
                found.insert((tree.root, false));
            }
            places.append(&mut found);
        }
    }

    /// Follows a path from inside a module; whether the module has its first name.
    fn descend(
        &self,
        module: Id,
        path: &[String],
        seen: &mut BTreeSet<(Id, Vec<String>)>,
        places: &mut Places,
    ) -> bool {
        let Some((first, rest)) = path.split_first() else {
            places.insert((module, true));
            return true;
        };
        let members = self.modules[module].members.get(first).map_or(&[][..], Vec::as_slice);
        for member in members {
            match member {
                Member::Module(child) => {
                    if !self.descend(*child, rest, seen, places) {
                        // A name that a macro makes there.
                        places.insert((*child, false));
                    }
                }
                Member::Item => {
                    places.insert((module, false));
                }
                Member::Import(import) => {
                    let mut found = Places::new();
                    let within = import.first().is_some_and(|first| first == "self");
                    let path = [&import[usize::from(within)..], rest].concat();
                    if path.first() != Some(first) {
                        self.follow(module, &[import.as_slice(), rest].concat(), seen, &mut found);
                    } else {
                        // `use check::check` and `use self::check::check`: its first name is not the one it brings in.
                        let mut modules = members.iter().filter_map(Member::module).peekable();
                        if modules.peek().is_none() && !within {
                            self.follow_crate(module, &path, seen, &mut found);
                        }
                        for child in modules {
                            self.descend(child, &path[1..], seen, &mut found);
                        }
                    }
                    // From a crate of others: handed on by this module.
                    if found.is_empty() {
                        found.insert((module, false));
                    }
                    places.append(&mut found);
                }
            }
        }
        if members.is_empty() {
            // Two modules may open each other.
            let key = (module, [&["*".to_owned()], path].concat());
            let opens = self.modules[module].opens.iter();
            return seen.insert(key) && opens.filter(|&&to| self.descend(to, path, seen, places)).count() > 0;
        }
        true
    }
}

/// Where a module goes.
struct Place<'a> {
    tree: usize,
    parent: Option<Id>,
    room: Vec<String>,
    file: &'a Path,
    folder: PathBuf,
}

fn parsed(text: Text, file: &Path) -> Result<Source, Failure> {
    let text = text(file).ok_or_else(|| Failure::found(format!("{}: cannot be read", file.display())))?;
    source::read(&text).map_err(|e| Failure::found(format!("{}:{e}", file.display())))
}
