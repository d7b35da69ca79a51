//! Shader linker: `#import "optics/fresnel"` includes `shaders/optics/fresnel.wgsl` once.
//!
//! The shaders are part of the program. For development, the environment variable [`FOLDER_VARIABLE`] names a folder from
//! which modules are read instead, without recompiling the program.

use std::path::Path;

use include_dir::{Dir, include_dir};

pub use super::generated_shader::GENERATED;
use super::traversal::Traversal;

static SHADERS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../shaders");

/// Environment variable with a folder of shaders that replace the program's own.
pub const FOLDER_VARIABLE: &str = "GLOSSMITH_SHADERS";

/// The name under which modules import the traversal; which module it is, is chosen when they are linked.
const TRAVERSAL: &str = "scene/traversal";
/// Name in [`Linked::locate`] of the WGSL extensions that modules enable, which come first.
pub const EXTENSIONS: &str = "extensions";

/// A shader with everything that it imports.
#[derive(Clone, Debug, Default)]
pub struct Linked {
    /// The linked WGSL.
    pub source: String,
    /// The modules in their order, each with the line (from 1) of `source` at which it begins.
    pub modules: Vec<(String, usize)>,
    traversal: Traversal,
    /// Lines that enable extensions.
    extensions: Vec<String>,
}

impl Linked {
    /// Module and line (from 1) of a line of the linked source.
    pub fn locate(&self, line: usize) -> (&str, usize) {
        let begun = self.modules.iter().rev().find(|(_, first)| *first <= line);
        begun.map_or(("", line), |(module, first)| (module.as_str(), line - first + 1))
    }

    /// Appends WGSL as a module of this name; each of its lines becomes one line.
    fn append(&mut self, module: &str, text: &str) {
        self.modules.push((module.to_owned(), self.source.lines().count() + 1));
        for line in text.lines() {
            // Moved lines leave an empty one, so that line numbers stay those of the file.
            let is_elsewhere = line.starts_with("#import") || line.starts_with(ENABLE);
            self.source.push_str(if is_elsewhere { "" } else { line });
            self.source.push('\n');
        }
    }

    fn add(&mut self, module: &str) -> Result<(), String> {
        let module = match module {
            TRAVERSAL => self.traversal.module(),
            module => module,
        };
        if self.modules.iter().any(|(name, _)| name == module) {
            return Ok(());
        }
        // Claimed before its imports, so that a circle of imports ends.
        let place = self.modules.len();
        self.modules.push((module.to_owned(), 0));
        let text = module_source(module)?;
        for line in text.lines().filter_map(|line| line.strip_prefix("#import \"")) {
            self.add(line.trim_end().trim_end_matches('"'))?;
        }
        self.modules.remove(place);
        self.append(module, &text);
        let enabled = text.lines().filter(|line| line.starts_with(ENABLE));
        self.extensions.extend(enabled.map(|line| format!("{line}\n")));
        Ok(())
    }

    /// Puts the extensions first, as WGSL requires.
    fn finished(mut self) -> Self {
        let extensions = std::mem::take(&mut self.extensions);
        if !extensions.is_empty() {
            self.modules
                .iter_mut()
                .for_each(|(_, first)| *first += extensions.len());
            self.modules.insert(0, (EXTENSIONS.to_owned(), 1));
            self.source.insert_str(0, &extensions.concat());
        }
        self
    }
}

/// Prefix of a line that enables a WGSL extension.
const ENABLE: &str = "enable ";

/// A module of `shaders/` with everything that it imports, for rays through our own hierarchy.
///
/// # Errors
/// Names the module that does not exist.
pub fn link(module: &str) -> Result<Linked, String> {
    link_for(module, Traversal::Own)
}

/// The same for another traversal.
///
/// # Errors
///
/// With the name of a missing module.
pub fn link_for(module: &str, traversal: Traversal) -> Result<Linked, String> {
    let mut linked = Linked {
        traversal,
        ..Linked::default()
    };
    linked.add(module)?;
    Ok(linked.finished())
}

/// Name in [`Linked::locate`] of source beyond the modules.
pub const EXTRA: &str = "extra source";

/// Modules of `shaders/` with everything that they import, then `extra_source`, which may use all of it: an entry point
/// around functions that have none.
///
/// # Errors
/// Names the module that does not exist.
pub fn link_with(modules: &[&str], extra_source: &str) -> Result<Linked, String> {
    let mut linked = Linked::default();
    for module in modules {
        linked.add(module)?;
    }
    linked.append(EXTRA, extra_source);
    Ok(linked.finished())
}

/// The names of all modules in `shaders/`.
pub fn module_names() -> Vec<String> {
    fn collect(dir: &Dir<'_>, names: &mut Vec<String>) {
        for file in dir.files() {
            if let Some(name) = file.path().to_str().and_then(|path| path.strip_suffix(".wgsl")) {
                names.push(name.replace('\\', "/"));
            }
        }
        dir.dirs().for_each(|dir| collect(dir, names));
    }
    let mut names = Vec::new();
    collect(&SHADERS, &mut names);
    names
}

fn module_source(module: &str) -> Result<String, String> {
    if let Some((_, generate)) = GENERATED.iter().find(|(name, _)| *name == module) {
        return Ok(generate());
    }
    let name = format!("{module}.wgsl");
    if let Some(folder) = std::env::var_os(FOLDER_VARIABLE)
        && let Ok(text) = std::fs::read_to_string(Path::new(&folder).join(&name))
    {
        return Ok(text);
    }
    let file = SHADERS.get_file(name);
    file.and_then(|file| file.contents_utf8())
        .map(str::to_owned)
        .ok_or_else(|| format!("no shader module {module}"))
}
