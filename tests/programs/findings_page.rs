//! `scenes/FINDINGS.md` lists every code of `sandtable check`. `SANDTABLE_BLESS=1 cargo test --test programs page_of_findings`
//! writes it.

use std::fmt::Write;
use std::path::Path;

use sandtable_description::finding::Severity;
use sandtable_description::finding_code::FindingCode;

const HEAD: &str = "# Findings of `sandtable check`

`sandtable check SCENE` loads a scene and lists what is wrong with it, or looks wrong, each finding with the line that caused
it. Errors make a picture wrong and let the check fail, with exit code 1; warnings do so with `--deny warnings`; notes say what
was done that the scene file does not state. `sandtable explain CODE` prints the text of a code.

With `--json` it prints one object, for scenes that are read and for those that are not:

| member | type | what it holds |
|---|---|---|
| `scene` | text | The scene file, as it was named. |
| `errors`, `warnings`, `notes` | number | How many findings there are of each. |
| `codes` | object of numbers | How often each code was found, with those that are counted and not listed. |
| `findings` | list of objects | The findings, in the order of the file. |
| `findings[].code` | text | One of the codes below; a code never changes its meaning. |
| `findings[].severity` | text | `error`, `warning` or `note`. |
| `findings[].file` | text or null | The scene file, or the included file, that it is about; null where it is about none. |
| `findings[].line`, `findings[].column` | number or null | Where in that file, from 1; columns count characters. |
| `findings[].message` | text | What was found, with numbers and units. |
| `findings[].help` | text or null | What to do. |
| `findings[].more` | number | How many more like it there are: of many in one table the worst is listed. |
";

fn page() -> String {
    let mut page = HEAD.to_owned();
    for (severity, title) in
        [(Severity::Error, "Errors"), (Severity::Warning, "Warnings"), (Severity::Note, "Notes")]
    {
        let _ = writeln!(page, "\n## {title}\n\n| code | what it means |\n|---|---|");
        for code in FindingCode::all().filter(|code| code.severity() == severity) {
            let _ = writeln!(page, "| `{}` | {} |", code.word(), code.text().replace('|', "\\|"));
        }
    }
    page
}

#[test]
fn the_page_of_findings_lists_the_codes_as_they_are_declared() {
    let file = Path::new(env!("SANDTABLE_ROOT")).join("scenes/FINDINGS.md");
    if std::env::var_os("SANDTABLE_BLESS").is_some() {
        std::fs::write(&file, page()).expect("writable");
    }
    let committed = std::fs::read_to_string(&file).expect("scenes/FINDINGS.md");
    assert!(committed == page(), "scenes/FINDINGS.md is outdated; write it with SANDTABLE_BLESS=1");
}
