"""What the two scripts that throw damaged and hostile files at the program have in common."""
