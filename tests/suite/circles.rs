//! Circles of modules inside a folder of `src`, read from the code's own paths (docs/ARCHITECTURE.md): modules that use each
//! other, directly or through others. A name that a module re-exports counts for the module that declares it. The root of a
//! folder belongs to all its modules: what it declares for them, and that it lists them, makes no circle.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use crate::structure::files_with;

/// A module as its file tells of it.
#[derive(Default)]
struct Module {
    /// What each name that it imports stands for.
    imports: BTreeMap<String, Vec<String>>,
    /// Every path that it names, imports included.
    paths: Vec<Vec<String>>,
}

/// All modules by their paths from the root of the crate, `["scene", "texture"]`.
type Modules = BTreeMap<Vec<String>, Module>;

/// The tokens of a file: identifiers, `::`, and single characters. Comments, strings, unit tests and what a macro names by
/// `$crate` are left out.
fn tokens(text: &str) -> Vec<&str> {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or(text);
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or(""));
    let mut found = Vec::new();
    for line in lines {
        // Every second piece is inside quotes; a quote as a character is none.
        for code in line.split('"').step_by(2) {
            let mut rest = code;
            while let Some(first) = rest.chars().next() {
                let is_word = |c: char| c.is_alphanumeric() || c == '_';
                let length = match first {
                    c if is_word(c) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
                    '$' => 1 + rest[1..].find(|c| !is_word(c) && c != ':').unwrap_or(rest.len() - 1),
                    ':' if rest.starts_with("::") => 2,
                    c => c.len_utf8(),
                };
                if !first.is_whitespace() {
                    found.push(&rest[..length]);
                }
                rest = &rest[length..];
            }
        }
    }
    found
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

impl Module {
    fn read(text: &str) -> Self {
        let mut module = Self::default();
        let mut rest = &tokens(text)[..];
        while let Some((&first, after)) = rest.split_first() {
            rest = after;
            if first == "use" {
                module.import(&mut rest, &[]);
            } else if is_name(first) {
                let mut path = vec![first.to_owned()];
                while let ["::", name, ..] = rest
                    && is_name(name)
                {
                    path.push((*name).to_owned());
                    rest = &rest[2..];
                }
                module.paths.extend((path.len() > 1).then_some(path));
            }
        }
        module
    }

    /// Reads one branch of a `use`, whose path begins with `before`, to the `,`, `}` or `;` behind it.
    fn import(&mut self, rest: &mut &[&str], before: &[String]) {
        let mut path = before.to_vec();
        let mut alias = None;
        while let Some((&token, after)) = rest.split_first() {
            match token {
                "," | "}" | ";" => break,
                "{" => {
                    *rest = after;
                    while !matches!(rest.first(), None | Some(&"}" | &";")) {
                        self.import(rest, &path);
                        *rest = rest.strip_prefix(&[","]).unwrap_or(rest);
                    }
                    *rest = rest.get(1..).unwrap_or_default();
                    return;
                }
                "as" => alias = after.first().map(|&name| name.to_owned()),
                "self" if !path.is_empty() => {}
                name if is_name(name) && alias.is_none() => path.push(name.to_owned()),
                _ => {}
            }
            *rest = after;
        }
        if let Some(name) = alias.or_else(|| path.last().cloned()) {
            self.imports.insert(name, path.clone());
            self.paths.push(path);
        }
    }
}

fn modules() -> Modules {
    let src = Path::new(crate::ROOT).join("src");
    let of_file = |file: &Path| {
        let below = file.strip_prefix(&src).unwrap().with_extension("");
        let mut path: Vec<String> = below.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
        path.pop_if(|last| ["mod", "lib"].contains(&last.as_str()));
        path
    };
    let files = files_with("rs", &src);
    let files = files.iter().filter(|file| !file.ends_with("tests.rs"));
    files
        .map(|file| (of_file(file), Module::read(&fs::read_to_string(file).unwrap())))
        .collect()
}

/// The module that declares what a module's path leads to; none where that is of another crate.
fn declared_in<'a>(modules: &'a Modules, from: &[String], path: &[String], depth: usize) -> Option<&'a [String]> {
    let child = |parent: &[String], name: &String| {
        let path = [parent, std::slice::from_ref(name)].concat();
        modules.get_key_value(&path).map(|(path, _)| &path[..])
    };
    let imported = |module: &[String], name: &String| modules[module].imports.get(name).filter(|_| depth > 0);
    let (first, mut rest) = path.split_first()?;
    let mut at = match first.as_str() {
        "glossmith_engine" => modules.get_key_value(&[][..])?.0,
        "crate" => {
            // A package of its own.
            let root = from.get(..1).filter(|folder| folder[0] == "import").unwrap_or_default();
            modules.get_key_value(root)?.0
        }
        "self" => from,
        "super" => {
            let parent = modules.get_key_value(from.split_last()?.1)?.0;
            if let Some(("super", _)) = rest.split_first().map(|(name, after)| (name.as_str(), after)) {
                return declared_in(modules, parent, rest, depth);
            }
            parent
        }
        _ => {
            rest = path;
            if child(from, first).is_none() {
                // An import, of which the rest of the path goes on; the name alone is told by the import itself.
                let target = imported(from, first).filter(|target| *target != path)?;
                return declared_in(modules, from, &[target, &path[1..]].concat(), depth - 1);
            }
            from
        }
    };
    while let Some((name, after)) = rest.split_first() {
        if let Some(next) = child(at, name) {
            at = next;
        } else if let Some(target) = imported(at, name) {
            return declared_in(modules, at, &[target, after].concat(), depth - 1);
        } else {
            break;
        }
        rest = after;
    }
    modules.get_key_value(at).map(|(path, _)| &path[..])
}

/// Who uses whom within a folder: modules of it, with what is below them, and a path that says so for each pair.
type Arrows = BTreeMap<String, BTreeMap<String, String>>;

/// The arrows of every folder.
fn arrows(modules: &Modules) -> BTreeMap<Vec<String>, Arrows> {
    let mut of_folder: BTreeMap<Vec<String>, Arrows> = BTreeMap::new();
    for (from, module) in modules {
        for path in &module.paths {
            let Some(to) = declared_in(modules, from, path, 8) else {
                continue;
            };
            let shared = from.iter().zip(to).take_while(|(a, b)| a == b).count();
            if let (Some(user), Some(used)) = (from.get(shared), to.get(shared)) {
                let arrows = of_folder.entry(from[..shared].to_vec()).or_default();
                let evidence = format!("{} names {}", from.join("/"), path.join("::"));
                let of_user = arrows.entry(user.clone()).or_default();
                of_user.entry(used.clone()).or_insert(evidence);
            }
        }
    }
    of_folder
}

/// All that a module uses, directly or through others.
fn reached<'a>(arrows: &'a Arrows, from: &str) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    let mut open = vec![from];
    while let Some(module) = open.pop() {
        for next in arrows.get(module).into_iter().flatten().map(|(next, _)| next.as_str()) {
            if found.insert(next) {
                open.push(next);
            }
        }
    }
    found
}

/// The circles of a folder: sets of modules each of which reaches all others.
fn circles(arrows: &Arrows) -> BTreeSet<BTreeSet<&str>> {
    let reach: BTreeMap<&str, BTreeSet<&str>> = arrows
        .keys()
        .map(|module| (module.as_str(), reached(arrows, module)))
        .collect();
    let circle = |module: &str| {
        let back = reach[module].iter().copied();
        back.filter(|other| reach.get(other).is_some_and(|there| there.contains(module)))
            .collect::<BTreeSet<&str>>()
    };
    reach
        .keys()
        .map(|module| circle(module))
        .filter(|circle| !circle.is_empty())
        .collect()
}

#[test]
fn no_circles_of_modules() {
    let modules = modules();
    let mut wrong = Vec::new();
    for (folder, arrows) in &arrows(&modules) {
        for circle in circles(arrows) {
            let names = circle.iter().copied().collect::<Vec<_>>().join(" ");
            wrong.push(format!("src/{}: {names}", folder.join("/")));
            for user in &circle {
                let within = arrows[*user].iter().filter(|(used, _)| circle.contains(used.as_str()));
                wrong.extend(within.map(|(used, evidence)| format!("    {user} -> {used}: {evidence}")));
            }
        }
    }
    assert!(wrong.is_empty(), "circles of modules:\n{}", wrong.join("\n"));
}

#[test]
fn the_reader_of_modules_follows_what_is_re_exported() {
    let read = |path: &[&str], text: &str| (path.iter().map(|&part| part.to_owned()).collect(), Module::read(text));
    let modules: Modules = [
        read(&[], "pub mod a;"),
        read(&["a"], "pub use inner::{Thing, other as renamed};"),
        read(
            &["a", "inner"],
            "use super::super::b; // use super::last::X;\nfn f() { b::g(\"a::last\") }",
        ),
        read(
            &["a", "last"],
            "use std::fs;\nuse crate::a::{renamed, self};\n#[cfg(test)]\nmod tests { use super::super::b; }",
        ),
        read(&["b"], "fn g() { crate::a::Thing::new(); fs::read(); }"),
    ]
    .into();
    let arrows = arrows(&modules);
    let pairs = |folder: &[String]| {
        let of_user = |(user, used): (&String, &BTreeMap<String, String>)| {
            used.keys().map(|used| format!("{user} {used}")).collect::<Vec<_>>()
        };
        arrows[folder].iter().flat_map(of_user).collect::<Vec<_>>()
    };
    assert_eq!(pairs(&[]), ["a b", "b a"]);
    assert_eq!(pairs(&["a".to_owned()]), ["last inner"]);
    assert_eq!(circles(&arrows[&[][..]]), BTreeSet::from([BTreeSet::from(["a", "b"])]));
}
