//! A bracket that is never closed: what follows it are errors of their own, none of which names it.

/// Byte offset of a bracket that a later line shows to be unclosed.
pub(super) fn unclosed(text: &str) -> Option<usize> {
    let mut open: Vec<(usize, char)> = Vec::new();
    let mut offset = 0;
    let mut lines = text.split_inclusive('\n');
    while let Some(line) = lines.next() {
        // A table's head or a key begins a line; neither can stand in an array.
        if let Some(&(at, '[')) = open.last()
            && begins_anew(line)
        {
            return Some(at);
        }
        match brackets(line, offset, &mut open) {
            Line::Mismatch(at) => return Some(at),
            Line::Done => offset += line.len(),
            Line::OpenText(end) => {
                // Up to the three quotes that end it, which may be lines away.
                let start = offset + line.len();
                let rest = &text[start..];
                offset = start + rest.find(end).map_or(rest.len(), |k| k + end.len());
                // What follows on that line is read as a line.
                lines = text[offset..].split_inclusive('\n');
            }
        }
    }
    open.last().map(|&(at, _)| at)
}

enum Line {
    Done,
    /// A closing bracket of another kind than the one opened here.
    Mismatch(usize),
    /// A string of several lines goes on until this.
    OpenText(&'static str),
}

/// Follows the brackets of a line that starts at this offset.
fn brackets(line: &str, offset: usize, open: &mut Vec<(usize, char)>) -> Line {
    let mut rest = line.char_indices();
    while let Some((k, c)) = rest.next() {
        let quotes = |three: &'static str| line[k..].starts_with(three).then_some(three);
        match c {
            '#' => return Line::Done,
            '"' | '\'' => {
                if let Some(three) = quotes("\"\"\"").or_else(|| quotes("'''")) {
                    let Some(end) = line[k + 3..].find(three) else { return Line::OpenText(three) };
                    while rest.as_str().len() > line.len() - (k + 3 + end + 3) {
                        rest.next();
                    }
                    continue;
                }
                let mut escaped = false;
                for (_, inside) in rest.by_ref() {
                    if inside == c && !escaped {
                        break;
                    }
                    escaped = c == '"' && inside == '\\' && !escaped;
                }
            }
            '[' | '{' => open.push((offset + k, c)),
            ']' | '}' => match open.pop() {
                Some((at, opened)) if (opened == '[') != (c == ']') => return Line::Mismatch(at),
                _ => {}
            },
            _ => {}
        }
    }
    Line::Done
}

/// Whether a line is `[name]`, `[[name]]` or begins with `key =`.
fn begins_anew(line: &str) -> bool {
    let line = line.split('#').next().unwrap_or_default().trim();
    let is_key = |text: &str| {
        !text.is_empty()
            && text.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.' | ' '))
    };
    let head = line.strip_prefix('[').and_then(|l| l.strip_suffix(']'));
    let head = head.map(|l| l.strip_prefix('[').and_then(|l| l.strip_suffix(']')).unwrap_or(l));
    // Numbers alone are an array's inside.
    let named = |text: &str| is_key(text) && text.chars().any(|c| c.is_ascii_alphabetic());
    head.is_some_and(named) || line.split_once('=').is_some_and(|(key, _)| is_key(key.trim()))
}

#[cfg(test)]
mod tests {
    use super::unclosed;

    #[test]
    fn the_bracket_that_is_not_closed_is_found() {
        for (text, at) in [
            ("a = [1, 2\nb = 3\n", Some(4)),
            ("a = [\n  [1, 2],\n  [3, 4\n]\n[fluid]\n", Some(4)),
            ("t = { min = [0.0, 0.0], max = [0.4, 0.3, open = [\"top\"] }\n", Some(30)),
            ("a = { b = 1\n", Some(4)),
            ("a = \"[\" # [\nb = '{'\n", None),
            ("a = \"\\\"[\"\n", None),
            ("a = \"\"\"[\n[ \"\"\"\nb = [1]\n", None),
            ("a = \"\"\"[\n[ \"\"\"\nb = [1\n", Some(19)),
            ("a = '''[''' # x\n", None),
            ("a = [\n 1, 2, # [\n [3.0, 4],\n]\n[[shape]]\n", None),
            ("a = [[0, 1],\n [2, 3]]\n[x.y]\n", None),
            ("", None),
        ] {
            assert_eq!(unclosed(text), at, "{text}");
        }
    }
}
