//! The names of files: without their folders, without their extensions, and unpacked.

/// The name without its folders.
pub(crate) fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// The name of the file in a packed file of this name.
pub(crate) fn unpacked_name(name: &str) -> String {
    let (base, extension) = split_extension(name);
    match extension.to_ascii_lowercase().as_str() {
        "gz" | "zip" => base.to_owned(),
        "btz" => format!("{base}.bt"),
        _ => name.to_owned(),
    }
}

/// The name before its extension, and the extension, which is empty where there is none.
pub(crate) fn split_extension(name: &str) -> (&str, &str) {
    match name.rsplit_once('.') {
        Some((base, extension)) if !extension.contains(['/', '\\']) => (base, extension),
        _ => (name, ""),
    }
}
