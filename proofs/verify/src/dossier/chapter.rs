//! Chapters of `spec/` as parts of the page.

use pulldown_cmark::{Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};

/// What a table of names and values has for its head.
const EMPTY_HEAD: &str = "<thead><tr><th></th><th></th></tr></thead>";

/// A chapter without its title, its headings two levels down, its tables in boxes that scroll. Links are left out: they
/// lead to other files of the source.
pub fn chapter(markdown: &str) -> String {
    let events = Parser::new_ext(markdown, Options::ENABLE_TABLES);
    let mut in_title = false;
    let shown = events.filter_map(|event| match event {
        Event::Start(Tag::Heading {
            level: HeadingLevel::H1,
            ..
        }) => {
            in_title = true;
            None
        }
        Event::End(TagEnd::Heading(HeadingLevel::H1)) => {
            in_title = false;
            None
        }
        _ if in_title => None,
        Event::Start(Tag::Link { .. }) | Event::End(TagEnd::Link) => None,
        event => Some(event),
    });
    let placed = shown.flat_map(|event| match event {
        Event::Start(Tag::Heading { .. }) => vec![Event::Html("<h3>".into())],
        Event::End(TagEnd::Heading(_)) => vec![Event::Html("</h3>\n".into())],
        Event::Start(Tag::Table(_)) => vec![
            Event::Html(
                "<div class=\"scroll chapter\" tabindex=\"0\" role=\"region\" aria-label=\"Table\">".into(),
            ),
            event,
        ],
        Event::End(TagEnd::Table) => vec![event, Event::Html("</div>\n".into())],
        event => vec![event],
    });
    let mut page = String::new();
    html::push_html(&mut page, placed);
    page.replace(EMPTY_HEAD, "")
}

/// The part of a chapter under a heading of the second level, without that heading.
pub fn part(markdown: &str, heading: &str) -> String {
    let start = format!("## {heading}\n");
    let part = markdown.split_once(&start).map_or("", |(_, after)| after);
    chapter(part.split("\n## ").next().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chapter_becomes_a_part_of_a_page() {
        let page = chapter(
            "# Title\n\nText with `a < b` and [a link](other.md).\n\n## Part\n\n| one | two |\n|---|---|\n| 1 & 2 | **bold** |\n",
        );
        assert_eq!(
            page,
            "<p>Text with <code>a &lt; b</code> and a link.</p>\n<h3>Part</h3>\n\
             <div class=\"scroll chapter\" tabindex=\"0\" role=\"region\" aria-label=\"Table\"><table><thead><tr><th>one</th><th>two</th></tr></thead><tbody>\n\
             <tr><td>1 &amp; 2</td><td><strong>bold</strong></td></tr>\n</tbody></table>\n</div>\n"
        );
    }

    #[test]
    fn a_table_of_names_and_values_has_no_empty_head_and_a_part_ends_where_the_next_begins() {
        let text = "# T\n\n## One\n\n| | |\n|---|---|\n| a | b |\n\n## Two\n\nend\n";
        let page = part(text, "One");
        assert!(
            page.contains("<td>a</td>") && !page.contains("thead") && !page.contains("end"),
            "{page}"
        );
        assert_eq!(part(text, "Two"), "<p>end</p>\n");
    }
}
