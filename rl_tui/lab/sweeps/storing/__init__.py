"""What a store is made of: its tables, its writer's lock, and the machine that its rows came from."""
