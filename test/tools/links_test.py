#!/usr/bin/python3
"""links_test.py ROOT: every relative link of the Markdown pages, and its anchor, leads somewhere."""
import re
import sys
from pathlib import Path


def prose(page):
    return re.sub(r'(?ms)^```.*?^```', '', page.read_text())


def anchors(page):
    """As GitHub makes them from headings."""
    found = set()
    for heading in re.findall(r'(?m)^#+ +(.*)$', prose(page)):
        words = re.sub(r'\[([^]]*)\]\([^)]*\)', r'\1', heading).lower()
        found.add(re.sub(r'[^\w\- ]', '', words).strip().replace(' ', '-'))
    return found


def broken(page, root):
    for target in re.findall(r'\]\(([^)\s]+)\)', prose(page)):
        if re.match(r'[a-z]+:', target):
            continue
        path, _, anchor = target.partition('#')
        file = (page.parent / path).resolve() if path else page
        if not file.exists():
            yield f'{page.relative_to(root)}: {target}: there is no such file'
        elif anchor and anchor not in anchors(file):
            yield f'{page.relative_to(root)}: {target}: there is no such heading'


def main():
    root = Path(sys.argv[1]).resolve()
    pages = sorted(root.glob('*.md')) + sorted((root / 'doc').glob('*.md'))
    links = sum(len(re.findall(r'\]\(', prose(page))) for page in pages)
    if links < 20:
        sys.exit(f'only {links} links were found: the pages are not where they are sought')
    errors = [error for page in pages for error in broken(page, root)]
    print('\n'.join(errors) or f'{links} links on {len(pages)} pages lead somewhere')
    sys.exit(1 if errors else 0)


main()
