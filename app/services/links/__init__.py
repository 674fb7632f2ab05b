"""The process that holds the links to the vehicles, as the service sees it: found, started, asked, ended."""
