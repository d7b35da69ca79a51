//! An Open Job Description template (jobtemplate-2023-09) of a batch: what render farms run.
//!
//! Its tasks are images, or parts of their samples; a step that depends on them joins the parts and writes the contact
//! sheets. Both steps call this program, so that workers need nothing else.

use std::path::Path;

use serde_json::Value as Json;

use super::file::BatchFile;

/// Names of a job have at most this many letters.
const NAME_LENGTH_MAX: usize = 128;

/// The template at `path` of a batch, by its number of images and of tasks per image.
pub fn text(path: &Path, file: &BatchFile, pictures: usize, slices: u32) -> String {
    let stem = file.path.file_stem().unwrap_or_default().to_string_lossy();
    let name: String = format!("Glossmith {stem}").chars().take(NAME_LENGTH_MAX).collect();
    let slice_definition = match slices {
        1 => String::new(),
        _ => format!("        - name: Slice\n          type: INT\n          range: \"1-{slices}\"\n"),
    };
    let slice_arguments = match slices {
        1 => String::new(),
        _ => format!(", \"--slice\", \"{{{{Task.Param.Slice}}}}/{slices}\""),
    };
    let common =
        "\"batch\", \"{{Param.BatchFile}}\", \"--folder\", \"{{Param.Folder}}\", \"--engine\", \"{{Param.Engine}}\"";
    format!(
        r#"specificationVersion: jobtemplate-2023-09
name: {name}
parameterDefinitions:
  - name: BatchFile
    description: The batch, with the files that it names beside it.
    type: PATH
    objectType: FILE
    dataFlow: IN
{batch}  - name: Folder
    description: The folder of the images, which all workers share.
    type: PATH
    objectType: DIRECTORY
    dataFlow: OUT
{folder}  - name: Glossmith
    description: The program.
    type: STRING
    default: glossmith
  - name: Engine
    description: The engine. On the CPU images are bit-identical.
    type: STRING
    allowedValues: [auto, gpu, cpu]
    default: auto
steps:
  - name: Render
    parameterSpace:
      taskParameterDefinitions:
        - name: Picture
          type: INT
          range: "1-{pictures}"
{slice_definition}    script:
      actions:
        onRun:
          command: "{{{{Param.Glossmith}}}}"
          args: [{common}, "--pictures", "{{{{Task.Param.Picture}}}}"{slice_arguments}]
  - name: Collect
    dependencies:
      - dependsOn: Render
    script:
      actions:
        onRun:
          command: "{{{{Param.Glossmith}}}}"
          args: [{common}, "--merge"]
"#,
        name = quoted(&name),
        batch = default(path, &file.path),
        folder = default(path, &file.folder),
    )
}

/// The line with the default of a path: the standard takes those below the template's own folder. Others have none, and are
/// given with the job.
fn default(template: &Path, path: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let folder = absolute(template).parent().map(Path::to_owned).unwrap_or_default();
    let path = absolute(path);
    let below = path
        .strip_prefix(&folder)
        .ok()
        .filter(|below| !below.as_os_str().is_empty());
    // Names that are not Unicode have to be given with the job.
    below
        .and_then(Path::to_str)
        .map_or_else(String::new, |below| format!("    default: {}\n", quoted(below)))
}

/// A text in YAML: JSON's marks and escapes are YAML's.
fn quoted(text: &str) -> String {
    Json::from(text).to_string()
}
