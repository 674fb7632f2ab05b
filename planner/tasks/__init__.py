"""The tasks a scenario may ask for: each the stages in turn, answering one question."""
