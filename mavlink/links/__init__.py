"""The kinds of link, one a file; ``mavlink.link`` chooses among them by address."""
