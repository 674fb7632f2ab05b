"""The kinds of link, one a file; ``mavlink.links.link`` chooses among them by address."""
