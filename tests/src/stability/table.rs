//! The table of `docs/stability.md`.

use super::runner::Row;

/// A family's rows as Markdown; cells that repeat the row above are empty.
pub fn table(title: &str, rows: &[Row]) -> String {
    let mut text = format!(
        "### {title}\n\n| case | solid | dx, mm | criterion | value | without the remedy |\n|---|---|---|---|---|---|\n"
    );
    let mut before: Option<&Row> = None;
    for row in rows {
        let new_case = before.is_none_or(|b| b.case != row.case);
        let new_run =
            new_case || before.is_none_or(|b| b.model != row.model || b.resolution != row.resolution);
        let name = if new_case { row.case.as_str() } else { "" };
        let (model, dx) = if new_run {
            (brief(&row.model), format!("{}", (row.resolution * 1e7).round() / 1e4))
        } else {
            ("", String::new())
        };
        let criterion =
            if new_run { format!("{} ({} steps)", row.criterion, row.steps) } else { row.criterion.clone() };
        text += &format!("| {name} | {model} | {dx} | {criterion} | {} | {} |\n", row.value, row.without);
        before = Some(row);
    }
    text
}

/// A solid model's name in the tables; empty without a solid.
pub(super) fn brief(model: &str) -> &'static str {
    match model {
        "hypoelastic" => "HE",
        "total-lagrangian" => "TL",
        "finite-element" => "FE",
        "rigid" => "R",
        _ => "",
    }
}

/// A page with the text between the two markers of this name replaced; `None` where it has no such markers.
pub fn replace_between_markers(page: &str, name: &str, text: &str) -> Option<String> {
    let (begin, end) = (format!("<!-- {name}: begin -->"), format!("<!-- {name}: end -->"));
    let (head, rest) = page.split_once(&begin)?;
    let (_, tail) = rest.split_once(&end)?;
    Some(format!("{head}{begin}\n\n{}\n\n{end}{tail}", text.trim()))
}

#[cfg(test)]
mod tests {
    use super::replace_between_markers;

    #[test]
    fn only_what_is_between_the_markers_changes() {
        let page = "a\n<!-- table: begin -->\nold\n<!-- table: end -->\nb\n";
        let new = replace_between_markers(page, "table", "new\n").unwrap();
        assert_eq!(new, "a\n<!-- table: begin -->\n\nnew\n\n<!-- table: end -->\nb\n");
        assert_eq!(replace_between_markers(page, "other", "b"), None);
    }
}
