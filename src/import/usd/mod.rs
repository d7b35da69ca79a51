//! USD files, by the openusd crate: text, binary and packages, composed with the files that they refer to.

mod material;
mod material_x;
mod mesh;
mod scene;
mod shape;

use std::{
    cell::RefCell,
    collections::HashMap,
    io::{self, Cursor, ErrorKind, Read as _},
    path::Path,
    rc::Rc,
};

pub use openusd;

use openusd::{
    ar::{Asset, ResolvedPath, Resolver},
    sdf::Value,
    usd::{Attribute, Prim, Stage},
    usda::parser::{ErrorHighlight, Parser},
};

pub(crate) use self::scene::load;

use crate::{files::Files, files::Import, panics::contained, scene::Loading};

/// Deepest nesting of brackets in a file as text, of prims, and longest chain of connections.
const DEPTH_MAX: usize = 256;
/// Bytes of stack for the crate, which goes down into prims and paths by recursion.
const STACK: usize = 256 << 20;

/// Layers of MaterialX, and what the crate takes them for.
const MATERIAL_X: &str = ".mtlx";
const AS_USD: &str = ".usda";

/// Finds layers and images among the files beside the first, by names that are seen from its folder: `kit/chair.usd`, or
/// `chair.usdz[textures/wood.png]` in a package.
struct Beside {
    files: Rc<Files>,
    read: Known,
}

/// Layers and images that were found, by their names.
type Known = Rc<RefCell<HashMap<String, Rc<[u8]>>>>;

impl Beside {
    fn bytes(&self, name: &str) -> io::Result<Rc<[u8]>> {
        if let Some(known) = self.read.borrow().get(name) {
            return Ok(known.clone());
        }
        let bytes: Rc<[u8]> = match packaged(name) {
            Some((package, inner)) => unpacked(&self.bytes(package)?, inner)?.into(),
            None => self.files.read(name)?.into(),
        };
        check_depth(&bytes)?;
        self.read.borrow_mut().insert(name.to_owned(), bytes.clone());
        Ok(bytes)
    }
}

/// A package and the name of a file in it.
fn packaged(name: &str) -> Option<(&str, &str)> {
    name.strip_suffix(']')?.split_once('[')
}

/// A file of a package, which must not be compressed.
fn unpacked(package: &[u8], inner: &str) -> io::Result<Vec<u8>> {
    let mut archive = zip::ZipArchive::new(Cursor::new(package))?;
    let mut bytes = Vec::new();
    archive
        .by_name(inner)?
        .take(package.len() as u64)
        .read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Refuses a text that is nested as no exporter nests it: it would exhaust the stack.
fn check_depth(bytes: &[u8]) -> io::Result<()> {
    if !bytes.starts_with(b"#usda") {
        return Ok(());
    }
    let mut depth = 0_usize;
    for byte in bytes {
        match byte {
            b'{' | b'(' | b'[' => depth += 1,
            b'}' | b')' | b']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > DEPTH_MAX {
            let what = format!("its parts are nested more than {DEPTH_MAX} deep");
            return Err(io::Error::new(ErrorKind::InvalidData, what));
        }
    }
    Ok(())
}

impl Resolver for Beside {
    fn create_identifier(&self, asset: &str, anchor: Option<&ResolvedPath>) -> String {
        let anchor = anchor.map_or_else(String::new, |anchor| anchor.to_string_lossy().into_owned());
        let is_package = anchor.to_lowercase().ends_with(".usdz");
        let (package, within) = match packaged(&anchor) {
            Some((package, inner)) => (package, inner),
            None if is_package => (&anchor[..], ""),
            None => ("", &anchor[..]),
        };
        let folder = within.rfind('/').map_or("", |end| &within[..=end]);
        let is_whole = asset.starts_with('/') || asset.contains(":\\");
        let asset = asset.replace('\\', "/");
        let name = if is_whole {
            asset
        } else {
            normal(&format!("{folder}{asset}"))
        };
        if package.is_empty() {
            name
        } else {
            format!("{package}[{name}]")
        }
    }

    fn resolve(&self, name: &str) -> Option<ResolvedPath> {
        self.bytes(name).ok()?;
        // The crate goes by the ending.
        let is_material_x = name.ends_with(MATERIAL_X);
        Some(ResolvedPath::new(format!(
            "{name}{}",
            if is_material_x { AS_USD } else { "" }
        )))
    }

    fn resolve_for_new_asset(&self, _name: &str) -> Option<ResolvedPath> {
        None
    }

    fn open_asset(&self, path: &ResolvedPath) -> io::Result<Box<dyn Asset>> {
        let name = path.to_string_lossy();
        let material_x = name.strip_suffix(AS_USD).filter(|name| name.ends_with(MATERIAL_X));
        let bytes = self.bytes(material_x.unwrap_or(&name))?;
        let layer = match material_x {
            Some(_) => material_x::layer(&String::from_utf8_lossy(&bytes))
                .map_err(io::Error::other)?
                .into(),
            None => bytes.to_vec(),
        };
        check_depth(&layer)?;
        Ok(Box::new(Cursor::new(layer)))
    }
}

/// A path without `.`, and without `..` behind a folder.
fn normal(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// The stage of a file whose contents are given, and what is found on the way.
fn opened(path: &Path, bytes: Vec<u8>, files: Rc<Files>) -> Result<(Stage, Known), String> {
    check_depth(&bytes).map_err(|error| error.to_string())?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let read = Known::new(HashMap::from([(name.clone(), bytes.into())]).into());
    let beside = Beside {
        files,
        read: read.clone(),
    };
    let stage = contained(|| Stage::builder().resolver(beside).open(&name)).ok_or("its parts contradict each other")?;
    let fault = |error| line_of_fault(&read.borrow()[&name]).unwrap_or_else(|| format!("{error:#}"));
    stage.map_err(fault).map(|stage| (stage, read))
}

/// What the crate does not take in a text, with the line; `None` in other files.
fn line_of_fault(bytes: &[u8]) -> Option<String> {
    let mut parser = Parser::new(std::str::from_utf8(bytes).ok()?);
    let error = parser.parse().err()?;
    let ErrorHighlight { line, line_text, .. } = parser.last_error_highlight()?;
    Some(format!(
        "line {line} is not understood: {} ({error:#})",
        line_text.trim()
    ))
}

/// Does work on the stage of a file whose contents are given, with the stack that the crate needs. `None` where the crate gives up.
pub fn with_stage<T: Send>(
    path: &Path,
    bytes: Vec<u8>,
    loading: &Loading,
    work: impl FnOnce(&Stage) -> T + Send,
) -> Result<T, String> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let files = Files::in_folder(folder, &[], &Import::new(loading));
    let stage = move || opened(path, bytes, Rc::new(files)).map(|(stage, _)| work(&stage));
    deep(stage).unwrap_or_else(|| Err("its parts contradict each other".to_owned()))
}

/// Does work on a stack of its own; `None` where it panics or none can be had.
fn deep<T: Send>(work: impl FnOnce() -> T + Send) -> Option<T> {
    std::thread::scope(|scope| {
        let builder = std::thread::Builder::new().stack_size(STACK);
        let thread = builder.spawn_scoped(scope, || contained(work)).ok()?;
        thread.join().ok().flatten()
    })
}

/// What stands at the end of a connection.
pub enum End {
    /// A shader, and the name of its output.
    Node(Prim, String),
    Value(Attribute),
}

/// What an attribute is worth, by way of the inputs and outputs of graphs and materials. `None` where a connection leads nowhere.
pub fn end(attribute: Attribute) -> Option<End> {
    let mut attribute = attribute;
    for _ in 0..DEPTH_MAX {
        let next = attribute.connections().ok()?.into_iter().next();
        let Some(next) = next else {
            return Some(End::Value(attribute));
        };
        let (prim, property) = next.split_property()?;
        let prim = attribute.stage().prim(prim);
        if !prim.is_valid().unwrap_or(false) {
            return None;
        }
        if kind(&prim) == "Shader" {
            return Some(End::Node(prim, property.strip_prefix("outputs:")?.to_owned()));
        }
        attribute = attribute.stage().attribute(next.clone());
    }
    None
}

/// The name of a prim's schema; empty without one.
pub fn kind(prim: &Prim) -> String {
    let named = prim.type_name().ok().flatten();
    named.map_or_else(String::new, |kind| kind.to_string())
}

/// A text, a name, or a file's name as it is seen from the first file's folder.
pub fn text_of(attribute: &Attribute) -> Option<String> {
    match attribute.get::<Value>().ok()?? {
        Value::String(text) => Some(text),
        Value::Token(name) => Some(name.to_string()),
        Value::AssetPath(file) => Some(file.resolved_path().unwrap_or(file.asset_path()).to_owned()),
        _ => None,
    }
}
