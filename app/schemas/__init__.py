"""Bodies of requests and answers, by subject."""
