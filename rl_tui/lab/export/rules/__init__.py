"""Each action rule as the text of a script; a module is called as the rule is."""
