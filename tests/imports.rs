//! One direction of imports: rooms use rooms before them, and no file of `src` uses itself through
//! others.
//!
//! A file uses another where a `use` or a path names an item defined there, by way of re-exports as
//! well. Declarations of modules and re-exports are no uses, nor is what tests in `src` name.

#![allow(
    clippy::unwrap_used,
    reason = "a source that cannot be read fails the test"
)]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The rooms of `src`, each a file or a folder with the file of that name: one uses those before it.
const ROOMS: &str = "
    simd parallel pool wall_clock readable json_number saved_limit real rounding blossom count
    id error accuracy conflict conflict_index layers stats window hitbox cover
    trajectory orientation shape turning_box knots spans
    polynomial guess enclosure bounds narrow_phase
    broad_phase query search scene screen monitor
    lib internals guide";

/// One file of `src`.
#[derive(Default)]
struct Module {
    file: PathBuf,
    parent: usize,
    children: BTreeMap<String, usize>,
    items: BTreeSet<String>,
    /// Names that a `use` brings in, with their paths.
    imports: BTreeMap<String, Vec<String>>,
    /// Paths that count as uses.
    uses: Vec<Vec<String>>,
}

/// Place to which a path leads.
#[derive(Clone, Copy)]
enum Found {
    Module(usize),
    ItemOf(usize),
}

/// Returns names, `::`, signs and texts (with their first quote), without comments.
fn tokens(text: &str) -> Vec<String> {
    let text: Vec<char> = text.chars().collect();
    let at = |i: usize| text.get(i).copied().unwrap_or(' ');
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let (mut tokens, mut i) = (Vec::<String>::new(), 0);
    while i < text.len() {
        let start = i;
        i += 1;
        match (at(start), at(i)) {
            ('/', '/') => {
                while i < text.len() && at(i) != '\n' {
                    i += 1;
                }
                continue;
            }
            ('"', _) => {
                while at(i) != '"' {
                    i += 1 + usize::from(at(i) == '\\');
                }
                i += 1;
                tokens.push(text[start..i - 1].iter().collect());
                continue;
            }
            // A character; what is left of a lifetime is a name.
            ('\'', '\\') => i = (i + 2..).find(|&end| at(end) == '\'').unwrap() + 1,
            ('\'', _) if at(i + 1) == '\'' => i += 2,
            (':', ':') => i += 1,
            (c, _) if is_name(c) => {
                while is_name(at(i)) {
                    i += 1;
                }
            }
            _ => {}
        }
        if !at(start).is_whitespace() {
            tokens.push(text[start..i].iter().collect());
        }
    }
    tokens
}

/// Adds the names and paths of a `use` to `found`; returns the place after it.
fn use_tree(
    tokens: &[String],
    mut i: usize,
    mut path: Vec<String>,
    found: &mut Vec<(String, Vec<String>)>,
) -> usize {
    loop {
        match tokens[i].as_str() {
            "{" => {
                i += 1;
                while tokens[i] != "}" {
                    i = use_tree(tokens, i, path.clone(), found);
                    i += usize::from(tokens[i] == ",");
                }
                return i + 1;
            }
            ";" | "," | "}" => {
                path.pop_if(|name| name == "self");
                found.push((path.last().unwrap().clone(), path));
                return i;
            }
            "as" => {
                found.push((tokens[i + 1].clone(), path));
                return i + 2;
            }
            "*" => panic!("a glob hides what is used of {path:?}"),
            "::" => {}
            name => path.push(name.to_owned()),
        }
        i += 1;
    }
}

/// Returns the place after an item: after its `;`, or its last brace.
fn end_of_item(tokens: &[String], mut i: usize) -> usize {
    let mut depth = 0;
    loop {
        i += 1;
        match (tokens[i - 1].as_str(), depth) {
            (";", 0) | ("}", 1) => return i,
            ("{" | "(" | "[", _) => depth += 1,
            ("}" | ")" | "]", _) => depth -= 1,
            _ => {}
        }
    }
}

/// Reads a file and those of the modules below it; returns its number.
fn read(modules: &mut Vec<Module>, file: &Path, parent: usize) -> usize {
    let tokens = tokens(&std::fs::read_to_string(file).unwrap());
    let token = |i: usize| tokens.get(i).map_or("", String::as_str);
    let is_name = |i: usize| token(i).starts_with(|c: char| c.is_alphabetic() || c == '_');
    let folder = match file.file_stem().unwrap().to_str().unwrap() {
        "lib" | "mod" => file.with_file_name(""),
        _ => file.with_extension(""),
    };
    let (mut module, own) = (Module::default(), modules.len());
    (module.file, module.parent) = (file.to_owned(), parent);
    modules.push(Module::default());
    let (mut depth, mut i) = (0, 0);
    while i < tokens.len() {
        let before = |n: usize| i.checked_sub(n).map_or("", token);
        match token(i) {
            "#" if tokens[i..]
                .starts_with(&["#", "[", "cfg", "(", "test", ")", "]"].map(String::from)) =>
            {
                i = end_of_item(&tokens, i + 7);
                continue;
            }
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth -= 1,
            "use" if token(i + 1) != "<" => {
                let is_public = ["pub", ")"].contains(&before(1));
                let mut found = Vec::new();
                i = use_tree(&tokens, i + 1, Vec::new(), &mut found);
                if !is_public {
                    module
                        .uses
                        .extend(found.iter().map(|(_, path)| path.clone()));
                }
                module.imports.extend(found);
            }
            "mod" if token(i + 2) == ";" => {
                let name = &tokens[i + 1];
                let flat = folder.join(name).with_extension("rs");
                let nested = folder.join(name).join("mod.rs");
                let child = read(modules, if flat.exists() { &flat } else { &nested }, own);
                module.children.insert(name.clone(), child);
            }
            "macro_rules" => drop(module.items.insert(tokens[i + 2].clone())),
            "struct" | "enum" | "union" | "trait" | "fn" | "const" | "static" | "type"
                if depth == 0 && is_name(i + 1) =>
            {
                module.items.insert(tokens[i + 1].clone());
            }
            // serde names a module in a text, and takes this function from it.
            text if text.starts_with('"') && before(2) == "with" => {
                let path = text[1..].split("::").chain(["serialize"]);
                module.uses.push(path.map(str::to_owned).collect());
            }
            _ if is_name(i) && before(1) != "." && token(i + 1) == "::" => {
                let mut path = vec![tokens[i].clone()];
                while token(i + 1) == "::" && is_name(i + 2) {
                    i += 2;
                    path.push(tokens[i].clone());
                }
                module.uses.push(path);
            }
            _ => {}
        }
        i += 1;
    }
    modules[own] = module;
    own
}

/// Returns the place of a name in a module.
fn find(modules: &[Module], at: usize, name: &str, is_last: bool) -> Option<Found> {
    let module = &modules[at];
    let child = module.children.get(name).map(|&child| Found::Module(child));
    if module.items.contains(name) {
        return Some(Found::ItemOf(at));
    }
    let import = module.imports.get(name).filter(|path| **path != [name]);
    let import = import.filter(|_| is_last || child.is_none());
    import.map_or(child, |path| resolve(modules, at, path))
}

/// Returns the place to which a path leads from a module; nothing outside the crate.
fn resolve(modules: &[Module], at: usize, path: &[String]) -> Option<Found> {
    let mut found = Found::Module(at);
    for (i, name) in path.iter().enumerate() {
        let Found::Module(module) = found else { break };
        found = match name.as_str() {
            "crate" => Found::Module(0),
            "self" => found,
            "super" => Found::Module(modules[module].parent),
            // What a module has and does not spell out comes from a macro in it.
            name => find(modules, module, name, i + 1 == path.len())
                .or((i > 0).then_some(Found::ItemOf(module)))?,
        };
    }
    Some(found)
}

/// Adds all files that a file uses, directly or through others.
fn reach(uses: &[BTreeSet<usize>], from: usize, reached: &mut BTreeSet<usize>) {
    for &to in &uses[from] {
        if reached.insert(to) {
            reach(uses, to, reached);
        }
    }
}

/// Returns the files of `src`, their paths relative to it, and the files that each of them uses.
fn uses_of_files() -> (Vec<PathBuf>, Vec<BTreeSet<usize>>) {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut modules = Vec::new();
    read(&mut modules, &source.join("lib.rs"), 0);
    let used_by = |at: usize| -> BTreeSet<usize> {
        let paths = modules[at].uses.iter();
        let found = paths.filter_map(|path| match resolve(&modules, at, path)? {
            Found::ItemOf(file) if file != at => Some(file),
            _ => None,
        });
        found.collect()
    };
    let uses: Vec<BTreeSet<usize>> = (0..modules.len()).map(used_by).collect();
    // Nothing was read wrongly that leads nowhere.
    let all = uses.iter().map(BTreeSet::len).sum::<usize>();
    assert!(
        all > 2 * modules.len(),
        "{all} uses among {} files",
        modules.len()
    );
    let files = modules.iter();
    let files = files.map(|module| module.file.strip_prefix(&source).unwrap().to_owned());
    (files.collect(), uses)
}

#[test]
fn no_room_uses_a_later_one() {
    let (files, uses) = uses_of_files();
    let place = |file: &Path| {
        let room = Path::new(file.iter().next().unwrap()).with_extension("");
        let mut rooms = ROOMS.split_whitespace();
        let place = rooms.position(|name| room == Path::new(name));
        place.unwrap_or_else(|| panic!("{room:?} is in no order"))
    };
    let mut backwards = Vec::new();
    for (from, uses) in files.iter().zip(&uses) {
        let later = uses.iter().map(|&to| &files[to]);
        let later = later.filter(|to| place(to) > place(from));
        backwards.extend(later.map(|to| (from, to)));
    }
    assert!(backwards.is_empty(), "against the order: {backwards:#?}");
}

#[test]
fn no_file_uses_itself_through_others() {
    let (files, uses) = uses_of_files();
    let all_from = |at: usize| {
        let mut reached = BTreeSet::new();
        reach(&uses, at, &mut reached);
        reached
    };
    let reached: Vec<BTreeSet<usize>> = (0..files.len()).map(all_from).collect();
    let circle_of = |at: usize| {
        let back = reached[at].iter().filter(|&&to| reached[to].contains(&at));
        back.map(|&to| &files[to]).collect()
    };
    let circles: BTreeSet<Vec<&PathBuf>> = (0..files.len()).map(circle_of).collect();
    let circles: Vec<_> = circles.iter().filter(|files| !files.is_empty()).collect();
    assert!(circles.is_empty(), "files in circles: {circles:#?}");
}
