//! Documents of MaterialX as layers of USD, laid out as OpenUSD's plug-in lays them out: materials are `</MaterialX/Materials/NAME>`, and
//! have the nodes below them.

use roxmltree::Node;

use crate::xml;

/// The text of the layer.
pub fn layer(text: &str) -> Result<String, String> {
    let document = xml::parse(text)?;
    let root = document.root_element();
    let is_material = |node: &Node<'_, '_>| node.has_tag_name("surfacematerial");
    let materials = root.children().filter(is_material);
    let materials: String = materials.map(|node| prim(node, "/MaterialX/Materials")).collect();
    let nodes = root.children().filter(|node| !is_material(node));
    let nodes: String = nodes.map(|node| prim(node, "/MaterialX/Nodes")).collect();
    Ok(format!(
        "#usda 1.0\n(defaultPrim = \"MaterialX\")\ndef \"MaterialX\" {{\nclass \"Nodes\" {{\n{nodes}}}\ndef \"Materials\" {{\n{materials}}}\n}}\n"
    ))
}

/// An attribute as a name of USD.
fn named(node: Node<'_, '_>, attribute: &str) -> Option<String> {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = node.attribute(attribute)?.chars().map(plain).collect();
    name.starts_with(|c: char| !c.is_ascii_digit()).then_some(name)
}

/// A material, a graph with its nodes, or a node, beside others of a scope; nothing of what has no name.
fn prim(node: Node<'_, '_>, scope: &str) -> String {
    let Some(name) = named(node, "name") else {
        return String::new();
    };
    let (kind, inside) = (node.tag_name().name(), format!("{scope}/{name}"));
    let mut text = match (kind, named(node, "type")) {
        ("surfacematerial", _) => format!("def Material \"{name}\" (prepend references = </MaterialX/Nodes>) {{\n"),
        ("nodegraph", _) => format!("def NodeGraph \"{name}\" {{\n"),
        (_, Some(of)) => format!("def Shader \"{name}\" {{\nuniform token info:id = \"ND_{kind}_{of}\"\n"),
        _ => return String::new(),
    };
    for part in node.children() {
        let name = named(part, "name").unwrap_or_default();
        let found = match (kind, part.tag_name().name()) {
            ("surfacematerial", _) if name == "surfaceshader" => property(part, "outputs:mtlx:surface", &inside),
            (_, "input") => property(part, &format!("inputs:{name}"), scope),
            (_, "output") => property(part, &format!("outputs:{name}"), &inside),
            ("nodegraph", _) => Some(prim(part, &inside)),
            _ => None,
        };
        text += &found.unwrap_or_default();
    }
    text + "}\n"
}

/// An input or an output, connected or with a value.
fn property(place: Node<'_, '_>, name: &str, scope: &str) -> Option<String> {
    if let Some(interface) = named(place, "interfacename") {
        return Some(format!("token {name}.connect = <{scope}.inputs:{interface}>\n"));
    }
    if let Some(node) = named(place, "nodegraph").or(named(place, "nodename")) {
        let output = named(place, "output").unwrap_or_else(|| "out".to_owned());
        return Some(format!("token {name}.connect = <{scope}/{node}.outputs:{output}>\n"));
    }
    let plain = |text: &str| text.replace(['"', '@', '\\', '\n'], "");
    let text = plain(place.attribute("value")?);
    let number = |word: &str| word.trim().parse().ok().filter(|x: &f32| x.is_finite());
    let numbers: Option<Vec<f32>> = text.split(',').map(number).collect();
    let (kind, value) = match numbers.as_deref() {
        _ if place.attribute("type") == Some("filename") => ("asset", format!("@{text}@")),
        Some([x]) => ("float", x.to_string()),
        Some([x, y]) => ("float2", format!("({x}, {y})")),
        Some([r, g, b]) => ("color3f", format!("({r}, {g}, {b})")),
        Some([r, g, b, a]) => ("color4f", format!("({r}, {g}, {b}, {a})")),
        _ => ("string", format!("\"{text}\"")),
    };
    let space = place.ancestors().find_map(|node| node.attribute("colorspace"));
    let space = space.filter(|_| kind.starts_with(['a', 'c']));
    let space = space.map_or_else(String::new, |space| format!("(colorSpace = \"{}\")", plain(space)));
    Some(format!("{kind} {name} = {value} {space}\n"))
}
